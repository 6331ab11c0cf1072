#include "runtime_sections.h"
namespace xgc::bench {
int benchView(const Flags&) {
    return 0;
}
} // namespace xgc::bench
