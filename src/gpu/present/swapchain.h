// SPDX-License-Identifier: Apache-2.0
// The images of a window: acquires one, lets the caller draw it, and presents it. Follows changes of the window's size.
// All calls for one context come from the same thread.
#ifndef QUINTET_GPU_PRESENT_SWAPCHAIN_H
#define QUINTET_GPU_PRESENT_SWAPCHAIN_H

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "gpu/commands.h"
#include "gpu/context.h"

namespace quintet::gpu {

// An image to draw on. Its layout is COLOR_ATTACHMENT_OPTIMAL while commands are recorded.
struct RenderTarget {
  VkImageView view = VK_NULL_HANDLE;
  VkExtent2D size{};       // pixels
  std::uint32_t slot = 0;  // of resources that a frame in flight uses, below kFramesInFlight
};

class Swapchain {
 public:
  static constexpr std::uint32_t kFramesInFlight = 2;

  // `context` has a surface and outlives the swapchain. Throws VulkanError.
  explicit Swapchain(Context& context);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  VkFormat format() const { return format_.format; }  // of all images: UNORM, so that values are sRGB-encoded bytes

  // Draws and presents a frame. `windowSize`: pixels of the window, for surfaces that do not state their size. Returns
  // false and draws nothing if the window has no area, or if no image is available within a second. Throws VulkanError,
  // DeviceLostError.
  bool draw(VkExtent2D windowSize, const std::function<void(Commands&, const RenderTarget&)>& record);

 private:
  struct Image {
    VkImage handle = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkSemaphore drawn = VK_NULL_HANDLE;
  };

  void create(VkExtent2D windowSize);
  void createImages();
  void destroyImages();
  VkSemaphore makeSemaphore();
  bool present(std::uint32_t index);

  Context& context_;
  VkSurfaceFormatKHR format_{};
  VkSwapchainKHR handle_ = VK_NULL_HANDLE;
  VkExtent2D size_{};    // of the images
  VkExtent2D window_{};  // for which they were created
  bool outdated_ = true;
  std::vector<Image> images_;
  std::array<VkSemaphore, kFramesInFlight> acquired_{};
  std::array<std::uint64_t, kFramesInFlight> busyUntil_{};  // timeline value after which the slot is free
  std::uint32_t slot_ = 0;
};

}  // namespace quintet::gpu
#endif
