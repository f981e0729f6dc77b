// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <vector>

namespace hard_cases {

/// A row of the catalogue. A loss of more than 1e-6 needs an explanation.
struct HardCase {
    const char* name;
    const char* group;      ///< geometry, time, transport, signal, scan shapes, fits
    const char* why;        ///< it is hard
    const char* must_hold;  ///< what `bound` limits
    double bound;
    double (*worst)();  ///< measures it: mostly the worst relative error against extended precision
    const char* explanation = "";  ///< why no more can be had, or where the bound comes from
};

/// All cases, group by group.
const std::vector<HardCase>& catalogue();

/// The cases of the two largest groups; catalogue.cpp holds the others.
std::vector<HardCase> time_rows();
std::vector<HardCase> transport_rows();

/// The largest of some errors; what is no number is infinitely wrong, and so is too little tried.
class Worst {
 public:
    void add(double error) {
        if (!(error <= value_)) value_ = error >= 0.0 ? error : HUGE_VAL;
        ++count_;
    }
    /// at_least   errors that must have been added
    double value(int at_least = 1) const { return count_ >= at_least ? value_ : HUGE_VAL; }

 private:
    double value_ = 0.0;
    int count_ = 0;
};

}  // namespace hard_cases
