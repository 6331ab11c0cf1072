#pragma once

#include "flags.h"
#include "models.h"

#include <fmt/format.h>

#include <cstdio>

namespace xgc::bench {

/// Loads the sources that the flags want and calls `visit(subject)` for each. Returns 0, or the exit code of the first
/// that cannot be loaded, after a message.
template <typename Visit>
int forSubjects(const Flags& flags, const std::vector<Source>& sources, const Visit& visit) {
    for (const Source& source : sources) {
        if (!flags.wantsModel(source.name)) continue;
        Subject subject;
        if (const bake::Status s = load(source, subject); !s.ok()) {
            fmt::print(stderr, "{}\n", s.message);
            return int(s.outcome);
        }
        visit(subject);
    }
    return 0;
}

} // namespace xgc::bench
