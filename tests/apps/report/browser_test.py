#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Opens pages of `nlos report` and `nlos view` in headless Chromium and uses them.

    browser_test.py [--update] [--keep FOLDER] NLOS

Every page must load without a message of the console and without a request to anywhere, every view
must start, and what the controls move is read back from the page. The page of a small demo is compared
with screens/*.png: whole pictures, shrunk, because letters differ between systems; --update writes them
anew. --keep leaves pages and full screenshots in a folder to be looked at. Without Chromium, its driver
and python3-selenium: exit status 77.
"""
import argparse
import base64
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    from PIL import Image, ImageChops, ImageStat
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

DRIVER = Path("/usr/bin/chromedriver")
SCREENS = Path(__file__).resolve().parent / "screens"
ROOT = Path(__file__).resolve().parents[3]
START_S = 60          # for a view to start; software rendering on a busy machine
SHRUNK_WIDTH = 140    # of the pictures compared; letters become grey
MOST_DIFFERENT = 20.0  # mean of 255: other fonts move lines; light against dark is above 100


def check(condition, message):
    if not condition:
        raise AssertionError(message)


class Pages:
    """Results to show, made by the program in a folder of its own."""

    def __init__(self, program: str, folder: Path):
        self.program, self.folder = program, folder

    def nlos(self, *arguments) -> None:
        subprocess.run([self.program, *map(str, arguments)], cwd=ROOT, check=True,
                       stdout=subprocess.DEVNULL)

    def results(self, name: str) -> Path:
        folder = self.folder / name
        folder.mkdir()
        return folder

    def report(self, folder: Path, *options) -> Path:
        page = folder.with_suffix(".html")
        self.nlos("report", folder, "-o", page, *options)
        return page

    def demo(self) -> Path:
        folder = self.results("demo")
        scene = "scenes/letter/scene.json"
        self.nlos("render", scene, "-o", folder / "capture.h5", "--set", "scan.sensing_points=[24,24]")
        for method in ("lct", "bp"):
            self.nlos("reconstruct", folder / "capture.h5", "-o", folder / f"v_{method}.h5",
                      "--method", method)
            self.nlos("compare", folder / f"v_{method}.h5", scene, "-o", folder / f"m_{method}.json")
        return self.report(folder)

    def sequence(self) -> Path:
        folder = self.results("sequence")
        self.nlos("render", "scenes/box/gated.json", "-o", folder / "gated.h5",
                  "--set", "camera.resolution=[16,12]", "render.samples=4", "frames.count=6")
        return self.report(folder)

    def doppler(self) -> Path:
        folder = self.results("doppler")
        self.nlos("render", "scenes/traffic/scan.json", "-o", folder / "scan.h5",
                  "--set", "scan.sensing_points=[6,6]", "render.samples=16")
        return self.report(folder)

    def fit(self) -> Path:
        folder = self.results("fit")
        self.nlos("fit", "data/letter.h5", "scenes/letter/model.json", "-o", folder / "fit.json",
                  "--set", "start=given")
        return self.report(folder)

    def bench(self) -> Path:
        folder = self.results("bench")
        self.nlos("bench", "fit", "-o", folder, "--trials", 1, "--only", "direct_returns")
        return self.report(folder)

    def reduced(self) -> Path:
        """More than the page has room for: fewer and coarser views, thumbnails, a name that is no UTF-8."""
        folder = self.results("reduced")
        for name in (b"\xff", b"a", b"b", b"c", b"d", b"e"):
            for file in ("capture.h5", "v_lct.h5"):
                copy = os.path.join(os.fsencode(folder), name + b"_" + file.encode())
                shutil.copyfile(self.folder / "demo" / file, copy)
        page = self.report(folder, "--data-mb", "0.3")
        text = page.read_text(encoding="utf-8")  # all of it, or UnicodeDecodeError
        check("To keep this page within 0.3 MB" in text, "the page does not say that it is reduced")
        check("6 captures, 6 reconstructions" in text, "results are not counted")
        return page

    def list_of_points(self) -> Path:
        """Counts of a list of wall points in another group's kind of file, through nlos view."""
        page = self.folder / "view.html"
        counts = self.folder / "counts.npz"
        self.nlos("simulate-noise", "data/letter.h5", "-o", counts, "--photons", 2e4)
        self.nlos("view", counts, "scenes/letter/scene.json", "-o", page, "--no-browser")
        return page

    def turned_wall(self) -> Path:
        """A wall that stands elsewhere and looks along the world's x, and the letter before it."""
        folder = self.results("turned")
        scene, capture = self.folder / "turned.json", self.folder / "turned.h5"
        letter = {"mesh": str(ROOT / "scenes/letter/scene.glb"), "rotation_deg": [0, 90, 0],
                  "translation_m": [2, 0.5, -1]}
        scene.write_text(json.dumps({
            "relay_wall": {"center_m": [2, 0.5, -1], "normal": [1, 0, 0]}, "objects": {"letter": letter},
            "scan": {"sensing_points": [16, 16]}, "time_axis": {"num_bins": 512}}))
        self.nlos("render", scene, "-o", capture)
        self.nlos("reconstruct", capture, "-o", folder / "v.h5", "--method", "lct")
        return self.report(folder)

    def hostile(self) -> Path:
        folder = self.results("hostile")
        name = "<script>document.title='hurt'<\\script>\"'&" + 100 * "x"
        self.nlos("convert", "data/letter.h5", folder / f"{name}.npz")
        capture = folder / "long.npz"
        self.nlos("convert", "data/letter.h5", capture)
        metrics = {"depth_mae_m": 0.1, "mask_iou": 1, "rel_l2": None,
                   "result": "<img src=x onerror=\"document.title='hurt'\">" + 10000 * "y",
                   "reference": "</script><script>document.title='hurt'</script>"}
        (folder / "m.json").write_text(json.dumps(metrics))
        return self.report(folder)


class Browser:
    def __init__(self):
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
                         "--use-gl=angle", "--use-angle=swiftshader",
                         "--enable-unsafe-swiftshader", "--hide-scrollbars",
                         "--force-device-scale-factor=1"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service(str(DRIVER)))
        self.opened = set()  # addresses of pages

    def open(self, page: Path, width: int = 1400, scheme: str = "light") -> None:
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": scheme},
                         {"name": "prefers-reduced-motion", "value": "reduce"}]})
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False})
        self.opened.add(page.as_uri())
        self.driver.get(page.as_uri())
        self.start_views()
        self.settle()

    def settle(self) -> None:
        """Waits until the page keeps its size: views follow a new width some frames later."""
        frames = """const done = arguments[0], page = document.documentElement;
            requestAnimationFrame(() => requestAnimationFrame(
                () => done([page.scrollWidth, page.scrollHeight])));"""
        sizes = [None] * 4

        def is_still():
            sizes.append(self.driver.execute_async_script(frames))
            return sizes[-4:] == [sizes[-1]] * 4

        self.wait(is_still, "a page that keeps its size")

    def start_views(self) -> None:
        for view in self.views():
            self.driver.execute_script("arguments[0].scrollIntoView()", view)
            self.wait(lambda: view.get_attribute("data-started") or view.get_attribute("data-failed"),
                      f"start of {view.get_attribute('data-view')}")
            check(view.get_attribute("data-failed") is None, view.text)
        self.driver.execute_script("scrollTo(0, 0)")

    def wait(self, condition, what: str):
        end = time.monotonic() + START_S
        while time.monotonic() < end:
            if condition():
                return
            time.sleep(0.05)
        raise AssertionError(f"waited {START_S} s for {what}")

    def views(self, kind: str = ""):
        selector = f'.view[data-view="{kind}"]' if kind else ".view"
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def control(self, view, name: str, number: int = 0):
        return view.find_elements(By.CSS_SELECTOR, f'[data-control="{name}"]')[number]

    def click(self, element) -> None:
        self.driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
        element.click()

    def set(self, element, value) -> None:
        """Moves a slider or a list of choices, as a hand would."""
        self.driver.execute_script(
            "arguments[0].value = arguments[1];"
            "for (const name of ['input', 'change'])"
            " arguments[0].dispatchEvent(new Event(name, {bubbles: true}))", element, value)

    def expect(self, view, name: str, value: str) -> None:
        self.wait(lambda: view.get_attribute(f"data-{name}") == value,
                  f"{name} = {value}, which is {view.get_attribute(f'data-{name}')}")

    def pixels(self, canvas):
        """A digest of what a canvas shows."""
        return hash(self.driver.execute_script("return arguments[0].toDataURL()", canvas))

    def expect_quiet(self, page: Path) -> None:
        messages = [entry["message"] for entry in self.driver.get_log("browser")
                    if "GPU stall due to ReadPixels" not in entry["message"]]
        check(not messages, f"{page.name}: {messages}")
        for entry in self.driver.get_log("performance"):
            event = json.loads(entry["message"])["message"]
            if event["method"] != "Network.requestWillBeSent":
                continue
            url = event["params"]["request"]["url"]
            check(url.startswith(("data:", "blob:")) or url in self.opened, f"asks for {url}")

    def expect_no_sideways_scroll(self, page: Path) -> None:
        wide, shown = self.driver.execute_script(
            "return [document.documentElement.scrollWidth, innerWidth]")
        check(wide <= shown, f"{page.name} is {wide} pixels wide in {shown}")

    def picture(self) -> Image.Image:
        height = min(8000, self.driver.execute_script(  # more than textures hold comes out wrong
            "return document.documentElement.scrollHeight"))
        width = self.driver.execute_script("return innerWidth")
        data = self.driver.execute_cdp_cmd("Page.captureScreenshot", {
            "captureBeyondViewport": True,
            "clip": {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}})["data"]
        return Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")


def use_space(browser: Browser, view) -> None:
    scene = browser.control(view, "scene")
    browser.expect(view, "ready", "true")
    before = browser.pixels(scene)
    for name in ("side", "top", "wall"):
        browser.click(browser.control(view, f"view-{name}"))
        browser.expect(view, "camera", name)
        browser.wait(lambda: browser.pixels(scene) != before, f"another picture from {name}")
        before = browser.pixels(scene)
    browser.set(browser.control(view, "volume-mode"), "maximum")
    browser.expect(view, "mode", "maximum")
    browser.set(browser.control(view, "threshold"), 70)
    browser.expect(view, "threshold", "70")
    browser.wait(lambda: browser.pixels(scene) != before, "a volume")
    shown = view.get_attribute("data-results")
    browser.click(browser.control(view, "result"))
    browser.wait(lambda: view.get_attribute("data-results") != shown, "other results")


def use_animation(browser: Browser, view) -> None:
    picture = browser.control(view, "picture")
    slider = browser.control(view, "bin")
    slider.send_keys(Keys.HOME)
    first = int(view.get_attribute("data-bin"))
    before = browser.pixels(picture)
    for _ in range(3):
        slider.send_keys(Keys.ARROW_RIGHT)
    browser.expect(view, "bin", str(first + 3))
    check(browser.pixels(picture) != before, "the picture stays the same in other bins")
    scale = "log" if view.get_attribute("data-value-scale") != "log" else "linear"
    browser.set(browser.control(view, "value-scale"), scale)
    browser.expect(view, "value-scale", scale)
    browser.click(picture)
    browser.wait(lambda: view.get_attribute("data-cell"), "the histogram of a point")


def use_slices(browser: Browser, view) -> None:
    front = browser.control(view, "slice-xy")
    before = browser.pixels(front)
    slider = browser.control(view, "slider-z")
    browser.set(slider, int(slider.get_attribute("max")) // 3)
    browser.expect(view, "iz", str(int(slider.get_attribute("max")) // 3))
    browser.wait(lambda: browser.pixels(front) != before, "another slice")


def use_pair(browser: Browser, view) -> None:
    picture = browser.control(view, "picture")
    before = browser.pixels(picture)
    browser.set(browser.control(view, "divider"), 20)
    browser.expect(view, "position", "20")
    browser.wait(lambda: browser.pixels(picture) != before, "a moved divider")
    left = view.get_attribute("data-left")
    browser.click(browser.control(view, "swap"))
    browser.wait(lambda: view.get_attribute("data-right") == left, "swapped sides")


def use_table(browser: Browser) -> None:
    table = browser.driver.find_element(By.CSS_SELECTOR, "table.sortable")
    heading = table.find_elements(By.CSS_SELECTOR, "thead th")[1]
    column = lambda: [float(cell.get_attribute("data-value")) for cell in
                      table.find_elements(By.CSS_SELECTOR, "tbody tr > :nth-child(2)")]
    orders = set()
    for _ in range(2):
        browser.click(heading.find_element(By.CSS_SELECTOR, "button"))
        values = column()
        ascending = heading.get_attribute("aria-sort") == "ascending"
        check(values == sorted(values, reverse=not ascending), f"{values} is not sorted")
        orders.add(ascending)
    check(len(orders) == 2, "a second click turns the order around")


def voxel_shown(browser: Browser):
    """The numbers of the sentence that tells where the slices are cut."""
    slices = browser.views("slices")[0]
    said = slices.find_element(By.CLASS_NAME, "view-readout").text.replace("\u2212", "-")
    place = re.match(r"Voxel at wall x (\S+) m, wall y (\S+) m, depth (\S+) m"
                     r"(?: \(in the world (\S+), (\S+), (\S+) m\))?: value ", said)
    check(place, f"found {said!r}")
    return [None if number is None else float(number) for number in place.groups()]


def expect_world_beside_wall(browser: Browser, page: Path) -> None:
    browser.open(page)
    x, y, depth, *world = voxel_shown(browser)
    expected = [2 + depth, 0.5 + y, -1 - x]  # wall x is up x normal
    check(all(abs(a - b) < 2e-3 for a, b in zip(world, expected)), f"{world} instead of {expected}")
    browser.expect_quiet(page)


def use_demo(browser: Browser, page: Path) -> None:
    browser.open(page)
    use_space(browser, browser.views("space")[0])
    use_animation(browser, browser.views("animation")[0])
    use_slices(browser, browser.views("slices")[0])
    use_pair(browser, browser.views("pair")[0])
    use_table(browser)
    check(voxel_shown(browser)[3] is None, "the demo's wall has the world's frame")
    browser.expect_quiet(page)


def compare_screens(browser: Browser, page: Path, update: bool, keep) -> None:
    for width, scheme in ((1400, "light"), (420, "dark")):
        browser.open(page, width, scheme)
        browser.expect_no_sideways_scroll(page)
        picture = browser.picture()
        if keep:
            picture.save(keep / f"{page.stem}_{width}_{scheme}.png")
        shrunk = picture.resize((SHRUNK_WIDTH, SHRUNK_WIDTH * picture.height // picture.width),
                                Image.Resampling.BOX)
        stored = SCREENS / f"demo_{width}_{scheme}.png"
        if update:
            shrunk.save(stored, optimize=True)
            continue
        expected = Image.open(stored).convert("RGB")
        check(abs(shrunk.height - expected.height) <= 0.05 * expected.height,
              f"{stored.name}: {shrunk.height} rows high, was {expected.height}")
        difference = ImageChops.difference(shrunk.resize(expected.size), expected)
        mean = sum(ImageStat.Stat(difference).mean) / 3
        print(f"{stored.name}: differs by {mean:.2f} of 255")
        check(mean < MOST_DIFFERENT, f"{stored.name}: differs by {mean:.2f} of 255")


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("program")
    arguments = parser.parse_args()
    if not DRIVER.exists():
        print("skipped: there is no", DRIVER)
        return 77
    with tempfile.TemporaryDirectory() as folder:
        keep = arguments.keep
        if keep:
            keep.mkdir(parents=True, exist_ok=True)
        pages = Pages(arguments.program, keep or Path(folder))
        browser = Browser()
        try:
            demo = pages.demo()
            use_demo(browser, demo)
            expect_world_beside_wall(browser, pages.turned_wall())
            compare_screens(browser, demo, arguments.update, keep)
            for make in (pages.sequence, pages.doppler, pages.fit, pages.bench,
                         pages.list_of_points, pages.reduced, pages.hostile):
                page = make()
                browser.open(page)
                for animation in browser.views("animation"):
                    use_animation(browser, animation)
                browser.expect_quiet(page)
                check(browser.driver.title != "hurt", "a name was run")
                if keep:
                    browser.picture().save(keep / f"{page.stem}.png")
                print(page.name, "holds")
        finally:
            browser.driver.quit()
    return 0


if __name__ == "__main__":
    sys.exit(main())
