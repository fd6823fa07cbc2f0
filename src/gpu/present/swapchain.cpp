// SPDX-License-Identifier: Apache-2.0
#include "gpu/present/swapchain.h"

#include <algorithm>
#include <limits>

#include "gpu/error.h"
#include "gpu/instance.h"

namespace quintet::gpu {
namespace {

constexpr std::uint64_t kAcquireNanoseconds = 1'000'000'000;

VkSurfaceFormatKHR chooseFormat(const Context& context) {
  const auto query = instanceFunction<PFN_vkGetPhysicalDeviceSurfaceFormatsKHR>(context.instance(),
                                                                                "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::uint32_t count = 0;
  check(query(context.physicalDevice(), context.surface(), &count, nullptr), "list the formats of the window");
  std::vector<VkSurfaceFormatKHR> formats(count);
  check(query(context.physicalDevice(), context.surface(), &count, formats.data()), "list the formats of the window");
  for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM})
    for (const VkSurfaceFormatKHR& format : formats)
      if (format.format == wanted && format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) return format;
  throw Error("the window supports no format with 8 bits per channel");
}

VkSurfaceCapabilitiesKHR capabilitiesOf(const Context& context) {
  const auto query = instanceFunction<PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR>(
      context.instance(), "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  VkSurfaceCapabilitiesKHR capabilities{};
  check(query(context.physicalDevice(), context.surface(), &capabilities), "query the size of the window");
  return capabilities;
}

VkExtent2D imageSize(const VkSurfaceCapabilitiesKHR& capabilities, VkExtent2D windowSize) {
  constexpr std::uint32_t kUndefined = std::numeric_limits<std::uint32_t>::max();
  if (capabilities.currentExtent.width != kUndefined) return capabilities.currentExtent;
  if (windowSize.width == 0 || windowSize.height == 0) return {};
  const VkExtent2D& least = capabilities.minImageExtent;
  const VkExtent2D& most = capabilities.maxImageExtent;
  return {std::clamp(windowSize.width, least.width, most.width),
          std::clamp(windowSize.height, least.height, most.height)};
}

VkCompositeAlphaFlagBitsKHR compositeAlpha(const VkSurfaceCapabilitiesKHR& capabilities) {
  if (capabilities.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR)
    return VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  return VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
}

}  // namespace

Swapchain::Swapchain(Context& context) : context_(context), format_(chooseFormat(context)) {
  for (VkSemaphore& semaphore : acquired_) semaphore = makeSemaphore();
}

Swapchain::~Swapchain() {
  const VolkDeviceTable& vk = context_.vk();
  vk.vkDeviceWaitIdle(context_.device());
  destroyImages();
  if (handle_) vk.vkDestroySwapchainKHR(context_.device(), handle_, nullptr);
  for (const VkSemaphore semaphore : acquired_) vk.vkDestroySemaphore(context_.device(), semaphore, nullptr);
}

VkSemaphore Swapchain::makeSemaphore() {
  const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  check(context_.vk().vkCreateSemaphore(context_.device(), &info, nullptr, &semaphore), "create a semaphore");
  return semaphore;
}

void Swapchain::destroyImages() {
  const VolkDeviceTable& vk = context_.vk();
  for (const Image& image : images_) {
    vk.vkDestroyImageView(context_.device(), image.view, nullptr);
    vk.vkDestroySemaphore(context_.device(), image.drawn, nullptr);
  }
  images_.clear();
}

void Swapchain::create(VkExtent2D windowSize) {
  const VkSurfaceCapabilitiesKHR capabilities = capabilitiesOf(context_);
  const VolkDeviceTable& vk = context_.vk();
  window_ = windowSize;
  size_ = imageSize(capabilities, windowSize);
  check(vk.vkDeviceWaitIdle(context_.device()), "wait for the device");
  destroyImages();
  const VkSwapchainKHR old = handle_;
  handle_ = VK_NULL_HANDLE;
  VkResult result = VK_SUCCESS;
  if (size_.width > 0 && size_.height > 0) {
    VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = context_.surface();
    info.minImageCount = capabilities.minImageCount + 1;
    if (capabilities.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, capabilities.maxImageCount);
    info.imageFormat = format_.format;
    info.imageColorSpace = format_.colorSpace;
    info.imageExtent = size_;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.preTransform = capabilities.currentTransform;
    info.compositeAlpha = compositeAlpha(capabilities);
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;  // every device supports it
    info.clipped = VK_TRUE;
    info.oldSwapchain = old;
    result = vk.vkCreateSwapchainKHR(context_.device(), &info, nullptr, &handle_);
  }
  if (old) vk.vkDestroySwapchainKHR(context_.device(), old, nullptr);
  check(result, "create the images of the window");
  if (handle_) createImages();
  outdated_ = false;
}

void Swapchain::createImages() {
  const VolkDeviceTable& vk = context_.vk();
  std::uint32_t count = 0;
  check(vk.vkGetSwapchainImagesKHR(context_.device(), handle_, &count, nullptr), "list the images of the window");
  std::vector<VkImage> handles(count);
  check(vk.vkGetSwapchainImagesKHR(context_.device(), handle_, &count, handles.data()),
        "list the images of the window");
  for (const VkImage handle : handles) {
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = handle;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format_.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    images_.push_back({.handle = handle});
    check(vk.vkCreateImageView(context_.device(), &view, nullptr, &images_.back().view),
          "create a view of the window's image");
    images_.back().drawn = makeSemaphore();
  }
}

bool Swapchain::draw(VkExtent2D windowSize, const std::function<void(Commands&, const RenderTarget&)>& record) {
  const VolkDeviceTable& vk = context_.vk();
  constexpr int kAttempts = 3;  // the window can change again while its images are created
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (outdated_ || !handle_ || windowSize.width != window_.width || windowSize.height != window_.height)
      create(windowSize);
    if (!handle_) return false;
    context_.wait(busyUntil_[slot_]);
    std::uint32_t index = 0;
    const VkResult result = vk.vkAcquireNextImageKHR(context_.device(), handle_, kAcquireNanoseconds, acquired_[slot_],
                                                     VK_NULL_HANDLE, &index);
    if (result == VK_TIMEOUT || result == VK_NOT_READY) return false;
    if (result == VK_ERROR_OUT_OF_DATE_KHR) {
      outdated_ = true;
      continue;
    }
    check(result, "acquire an image of the window");
    const Image& image = images_[index];
    const RenderTarget target{image.view, size_, slot_};
    busyUntil_[slot_] = context_.submit(
        [&](Commands& commands) {
          commands.transition(image.handle, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
          record(commands, target);
          commands.transition(image.handle, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
        },
        {.wait = acquired_[slot_], .signal = image.drawn});
    slot_ = (slot_ + 1) % kFramesInFlight;
    if (!present(index) || result == VK_SUBOPTIMAL_KHR) outdated_ = true;
    return true;
  }
  return false;
}

// Returns false if the images no longer fit the window.
bool Swapchain::present(std::uint32_t index) {
  VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &images_[index].drawn;
  info.swapchainCount = 1;
  info.pSwapchains = &handle_;
  info.pImageIndices = &index;
  const VkResult result = context_.vk().vkQueuePresentKHR(context_.queue(), &info);
  if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) return false;
  check(result, "present an image");
  return true;
}

}  // namespace quintet::gpu
