#pragma once

#include <string>

namespace xgc::tool {

/// A progress bar on stderr: drawn only where stderr is a terminal and the caller is not quiet.
class Progress {
public:
    explicit Progress(bool quiet);
    ~Progress();
    void show(const char* stage, double fraction);

private:
    void clear();
    bool active_;
    std::string last_;
};

} // namespace xgc::tool
