#include <xgc/bake/hierarchy.h>

#include <array>
#include <cstdio>

// Links the bake pipeline as a tool does.
int main() {
    xgc::bake::Hierarchy hierarchy;
    hierarchy.domainPatches = {{0, 1}};
    const std::array<uint8_t, 2> levels = {3, 1};
    const uint32_t level = hierarchy.domainLevel(0, levels);
    std::printf("the border stands at level %u\n", level);
    return level == 1 ? 0 : 1;
}
