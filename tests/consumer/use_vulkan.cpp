#include <xgc/vulkan/camera.h>
#include <xgc/vulkan/headless_device.h>

#include <cstdio>

// Links the Vulkan backend as a renderer does. A machine without a device must be told so, not crash.
int main() {
    const xgc::vulkan::Camera camera =
        xgc::vulkan::framingCamera({0, 0, 0}, 1.0f, {0, 0, 1}, {0, 1, 0}, 0.7f, 16.0f / 9.0f);
    xgc::vulkan::HeadlessDevice device;
    const xgc::Status status = device.create();
    std::printf("%s; the eye is %.2f away\n", status.ok() ? device.name() : status.message, double(camera.eye.z));
    return camera.eye.z > 1 ? 0 : 1;
}
