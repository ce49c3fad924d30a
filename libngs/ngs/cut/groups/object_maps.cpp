#include "ngs/cut/groups/object_maps.h"

#include <algorithm>
#include <bit>

#include "ngs/backend/for_each.h"

namespace ngs {

ObjectMaps::ObjectMaps(const Exec& exec, const GaussianCloud& cloud, const SplatOptions& splat,
                       const GroupedObjects& objects)
    : cloud_(cloud), splat_(splat), objects_(objects), bits_(std::max(1, int(std::bit_width(objects.objects.size())))) {
  code_.resize(objects.object.size() * std::size_t(bits_));
  for_each_index(exec, std::ssize(objects.object), [&](std::int64_t i) {
    for (int b = 0; b < bits_; ++b)
      code_[std::size_t(i) * std::size_t(bits_) + std::size_t(b)] = float(objects.object[std::size_t(i)] >> b & 1);
  });
}

ImageU16 ObjectMaps::rendered(const Exec& exec, const Camera& camera) const {
  RenderRequest request{.colour = false, .label = {code_.data(), cloud_.size(), bits_}};
  const RenderedView view = render(exec, cloud_, camera, splat_, request);
  ImageU16 map(camera.width_px, camera.height_px, 1);
  for (std::size_t p = 0; p < map.data.size(); ++p) {
    // Each binary digit is decided by more than half of the pixel's weight. If no object has that much weight, the
    // digits may form the number of another object.
    std::uint32_t number = 0;
    for (int b = 0; b < bits_; ++b)
      number |= std::uint32_t(view.label.data[p * std::size_t(bits_) + std::size_t(b)] > 0.5f * view.alpha.data[p])
                << b;
    if (view.alpha.data[p] > 0.5f && number <= objects_.objects.size()) map.data[p] = std::uint16_t(number);
  }
  return map;
}

ImageU16 ObjectMaps::known(const Exec& exec, const Camera& camera) const {
  ImageU16 map = rendered(exec, camera);
  for (std::uint16_t& number : map.data)
    if (number > objects_.sure) number = NumberedMasks::kUnknown;
  return map;
}

ImageU16 ObjectMaps::corrected(const Exec& exec, const Camera& camera, const ViewGaussians& view,
                               const NumberedMasks& masks) const {
  const ImageU16 render = rendered(exec, camera);
  const std::vector<MaskContent> content = mask_contents(view, objects_);
  ImageU16 map = masks.number;
  for (int y = 0; y < map.height_px; ++y)
    for (int x = 0; x < map.width_px; ++x) {
      std::uint16_t& pixel = map.at(x, y);
      if (pixel == NumberedMasks::kUnknown) continue;
      const MaskContent& mask = content[pixel];
      const std::uint16_t shown = render.at(int(std::int64_t(x) * render.width_px / map.width_px),
                                            int(std::int64_t(y) * render.height_px / map.height_px));
      if (pixel == 0) {
        pixel = shown == 0 ? std::uint16_t(0) : NumberedMasks::kUnknown;
      } else {
        const bool is_one = mask.is_known && mask.share >= kOneObject;
        pixel = is_one ? std::uint16_t(mask.object) : mask.is_known ? shown : NumberedMasks::kUnknown;
        if (pixel > objects_.sure) pixel = NumberedMasks::kUnknown;
      }
    }
  return map;
}

}  // namespace ngs
