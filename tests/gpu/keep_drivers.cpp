// Software drivers and the validation layer leak a little and are unloaded before the leak check looks, which then
// cannot name them. Sanitized programs keep them loaded and say whose leaks are not ours.
#include <dlfcn.h>

#include <initializer_list>

extern "C" {
extern int xgcKeepDrivers; ///< the linker is told to keep it, and so this file
int xgcKeepDrivers = 1;
}

#if defined(__SANITIZE_ADDRESS__)
#define XGC_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define XGC_ADDRESS_SANITIZER
#endif
#endif

#ifdef XGC_ADDRESS_SANITIZER
namespace {

const bool kKept = [] {
    for (const char* file : {"libvulkan_lvp.so", "libVkLayer_khronos_validation.so"}) {
        dlopen(file, RTLD_NOW | RTLD_NODELETE);
    }
    return true;
}();

} // namespace

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libVkLayer_khronos_validation.so\nleak:libvulkan_lvp.so\nleak:libLLVM\n";
}
#endif
