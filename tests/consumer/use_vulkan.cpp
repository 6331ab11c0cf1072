#include <xgc/vulkan/camera.h>
#include <xgc/vulkan/headless_device.h>

#include <cstdio>

// Links the Vulkan backend as a renderer does. A machine without a device must be told so, not crash.
int main() {
    const glm::vec3 corners[] = {{-1, -1, -1}, {1, 1, 1}};
    const xgc::vulkan::Camera camera = xgc::vulkan::frame(corners, {});
    xgc::vulkan::HeadlessDevice device;
    const xgc::Status status = device.create();
    std::printf("%s; the eye is %.2f away\n", status.ok() ? device.name() : status.message, double(camera.eye.z));
    return camera.eye.z > 1 ? 0 : 1;
}
