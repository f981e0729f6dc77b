// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace core {

/// A result file that appears whole or not at all: written under a temporary name beside the
/// target, renamed by commit(), removed again when commit() is never reached. What a killed run
/// left of the same target is removed by the next one. Symbolic links stay: the file that they lead
/// to is written.
class OutputFile {
 public:
    /// Throws Error when the target's folder does not exist or cannot be written, or its name is
    /// too long.
    explicit OutputFile(std::string target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Where to write; ends in the target's suffix.
    const std::string& temporary() const { return temporary_; }

    /// Moves the finished file to its final name. Throws Failure when that fails.
    void commit();

 private:
    std::string target_;
    std::string written_;  ///< where symbolic links from the target lead
    std::string temporary_;
    bool committed_ = false;
};

/// The file that OutputFile writes in this process on the way to `target`:
/// `.NAME.PROCESS-MACHINE.partial.SUFFIX` beside NAME.SUFFIX.
std::string partial_file_of(const std::string& target);

/// Removes what is being written now; for signal handlers that end the program (it is safe there).
void remove_partial_files() noexcept;

/// Checks targets before the work, so that a run does not fail only when it writes its result.
///
/// targets   files to be written; empty names are skipped
/// inputs    files that are read
/// throws    Error when a target cannot be written, or is one of the inputs
void check_targets(const std::vector<std::string>& targets, const std::vector<std::string>& inputs);

/// Writes a whole text file through OutputFile.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace core
