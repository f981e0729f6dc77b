// SPDX-License-Identifier: MIT
#include "renderer/scene_import/foreign_file.h"

#include "renderer/core/error.h"
#include "renderer/core/random.h"
#include "renderer/core/settings/json_file.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace {

using core::Json;
using test_support::TemporaryFolder;
using test_support::write_file_bytes;

Json read_text(const std::string& name, const std::string& text) {
    const TemporaryFolder folder;
    write_file_bytes(folder.file(name), text);
    return name.ends_with(".xml") ? renderer::read_mitsuba_xml(folder.file(name))
                                  : renderer::read_yaml(folder.file(name));
}

std::string repeated(const std::string& text, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) all += text;
    return all;
}

TEST(ForeignFile, XmlBecomesMitsubasDictionary) {
    const Json scene = read_text("a.xml", R"(<scene version="3.0.0">
        <default name="size" value="12"/>
        <film type="hdrfilm" id="film"><integer name="width" value="$size"/>
          <float name="gain" value="+1.5e-1"/><boolean name="on" value="true"/>
          <string name="file" value="out$size.exr"/><point name="at" x="1" z="3"/>
          <vector name="along" value="1 2 3"/><rgb name="tint" value="0.1, 0.2, 0.3"/>
        </film><ref id="film"/><ref id="film"/></scene>)");
    EXPECT_EQ(scene["type"], "scene");
    const Json film = scene["film"];
    EXPECT_EQ(film["type"], "hdrfilm");
    EXPECT_EQ(film["width"], 12);
    EXPECT_EQ(film["gain"], 0.15);
    EXPECT_EQ(film["on"], true);
    EXPECT_EQ(film["file"], "out12.exr");
    EXPECT_EQ(film["at"], (Json{1.0, 0.0, 3.0}));
    EXPECT_EQ(film["along"], (Json{1.0, 2.0, 3.0}));
    EXPECT_EQ(film["tint"]["value"], (Json{0.1, 0.2, 0.3}));
    EXPECT_EQ(scene["ref"]["id"], "film");
    EXPECT_EQ(scene["ref_2"]["id"], "film");
}

TEST(ForeignFile, YamlScalarsAreThoseOfYaml11) {
    const Json read = read_text("a.yaml",
                                "a: 1_000\nb: 1.5\nc: yes\nd: 'yes'\ne:\nf: ~\ng: [1, x]\n"
                                "h: &anchor {k: -2}\ni: *anchor\nj: 1_a\n");
    EXPECT_EQ(read, Json::parse(R"({"a": 1000, "b": 1.5, "c": true, "d": "yes", "e": null,
        "f": null, "g": [1, "x"], "h": {"k": -2}, "i": {"k": -2}, "j": "1_a"})"));
}

TEST(ForeignFile, EntitiesAreRefused) {
    const std::string laughs =
        "<!DOCTYPE lolz [<!ENTITY a \"lol\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\">]>"
        "<scene version=\"3.0.0\"><string name=\"x\" value=\"&b;\"/></scene>";
    EXPECT_ERROR_WITH(read_text("a.xml", laughs), "document type");
    EXPECT_ERROR_WITH(
        read_text("a.xml", "<!DOCTYPE s SYSTEM \"file:///etc/passwd\"><scene>&s;</scene>"),
        "document type");
}

TEST(ForeignFile, DeepNestsAreRefused) {
    EXPECT_ERROR_WITH(read_text("a.xml",
                                "<scene>" + repeated("<bsdf type='a'>", 200'000) +
                                    repeated("</bsdf>", 200'000) + "</scene>"),
                      "nests deeper");
    EXPECT_ERROR_WITH(read_text("a.yaml", repeated("[", 200'000) + repeated("]", 200'000)),
                      "a.yaml: ");
    EXPECT_ERROR_WITH(read_text("a.yaml", repeated("[", 100) + repeated("]", 100)), "nests deeper");
}

TEST(ForeignFile, AliasesThatMultiplyAreRefused) {
    std::string laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int i = 1; i < 10; ++i) {
        const std::string before = "*a" + std::to_string(i - 1);
        laughs += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" +
                  repeated(before + ", ", 9) + before + "]\n";
    }
    EXPECT_ERROR_WITH(read_text("a.yaml", laughs), "holds more than");
    EXPECT_ERROR_WITH(read_text("a.yaml", "a: &a [*a]\n"), "a.yaml: ");
}

TEST(ForeignFile, DamagedFilesAreNamed) {
    EXPECT_ERROR_WITH(read_text("a.xml", "<scene><shape></scene>"), "is no valid XML");
    EXPECT_ERROR_WITH(read_text("a.xml", ""), "a.xml: ");
    EXPECT_ERROR_WITH(read_text("a.xml", "<scene><float name='a' value='x'/></scene>"),
                      "found <float value=\"x\">");
    EXPECT_ERROR_WITH(read_text("a.xml", "<scene><integer name='a' value='1e300'/></scene>"),
                      "must be a whole number");
    EXPECT_ERROR_WITH(read_text("a.xml", "<scene><integer name='a' value='$n'/></scene>"),
                      "uses $n without a <default>");
    EXPECT_ERROR_WITH(read_text("a.xml", "<scene><transform name='t'><shear/></transform></scene>"),
                      "found <shear> in a transform");
    EXPECT_ERROR_WITH(read_text("a.yaml", "a: [1\nb: }"), "is no valid YAML");
    EXPECT_ERROR_WITH(read_text("a.yaml", "? [1]\n: 2\n"), "has a key that is no text");
}

TEST(ForeignFile, MutatedFilesAreReadOrRefusedInOneLine) {
    const std::pair<std::string, std::string> files[]{
        {"a.xml",
         "<scene version='3.0.0'><default name='n' value='3'/><shape type='obj' id='a'><transform "
         "name='to_world'><scale value='2'/><rotate y='1' angle='90'/></transform><float name='f' "
         "value='$n'/></shape></scene>"},
        {"a.yaml", "name: x\nlist:\n- a: &a {k: 1.5}\n  b: *a\ntext: |\n  <bsdf/>\n"}};
    for (const auto& [name, text] : files) {
        for (std::uint64_t trial = 0; trial < 150; ++trial) {
            core::Rng rng(11, trial, text.size());
            std::string mutant = text;
            for (std::uint64_t i = 0; i <= trial % 4; ++i) {
                mutant[rng.next_bits() % mutant.size()] = static_cast<char>(rng.next_bits());
            }
            if (trial % 5 == 0) mutant.resize(rng.next_bits() % mutant.size());
            try {
                read_text(name, mutant);
            } catch (const core::Error& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
            }
        }
    }
}

}  // namespace
