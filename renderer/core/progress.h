// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

namespace core {

/// How long-running work reports to its caller. Nothing below the program itself prints.
struct Progress {
    /// Called before long work starts, with what it will do and need. May be empty.
    std::function<void(const std::string& text)> announce;

    /// Called likewise, with what casts doubt on the result. May be empty.
    std::function<void(const std::string& text)> warn;

    /// Called regularly from the calling thread: the fraction done in [0, 1] and a short text such
    /// as the rate. May be empty.
    std::function<void(double fraction, const std::string& detail)> report;

    /// Called when a stage of the work begins, the next of so many; `report` then tells the
    /// fraction of the stage. May be empty.
    std::function<void(int number, int count, const std::string& name)> begin_stage;

    /// Called between passes; true ends the work early with what it has so far. May be empty.
    std::function<bool()> stop_requested;

    /// The progress of a part of the work that takes it from fraction `begin` to `end`. Refers to
    /// this. Stages within the part are parts of it.
    Progress part(double begin, double end) const {
        Progress result = *this;
        result.begin_stage = nullptr;
        result.report = [this, begin, end](double fraction, const std::string& detail) {
            update(begin + (end - begin) * fraction, detail);
        };
        return result;
    }

    /// The progress of one of the stages that the work consists of, which begins now; for who does
    /// not ask for stages, the part from fraction `begin` to `end`. Refers to this.
    Progress stage(int number, int count, const std::string& name, double begin, double end) const {
        if (!begin_stage) return part(begin, end);
        begin_stage(number, count, name);
        return part(0.0, 1.0);
    }

    void update(double fraction, const std::string& detail) const {
        if (report) report(fraction, detail);
    }
    bool should_stop() const { return stop_requested && stop_requested(); }
};

}  // namespace core
