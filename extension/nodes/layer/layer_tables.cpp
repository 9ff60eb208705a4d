#include "nodes/layer/layer_tables.hpp"

#include <array>
#include <cstdint>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

bool same_area(const MaskFrame &a, const MaskFrame &b) {
	return a.area.min == b.area.min && a.area.max == b.area.max && a.edge == b.edge;
}

/// Creates a line from 1 at distance 0 to 0 at `distance` (meters).
std::shared_ptr<const CurveTable> falling_line(double distance) {
	constexpr std::array<float, 2> ends{1.0F, 0.0F};
	const auto table = std::make_shared<CurveTable>();
	const Status status = table->set(0.0, distance, ends);
	return status.ok() ? table : nullptr;
}

} // namespace

void LayerTables::refresh(const MaskFrame &frame, double proximity_distance) {
	refresh_noise();
	refresh_image(frame);
	replace(proximity_line, falling_line(proximity_distance));
}

void LayerTables::refresh_noise() {
	if (noise_source == used_source_ && noise_curve == used_curve_) {
		// Keep the field while its sources are unchanged, because a new field regenerates tiles.
		return;
	}
	used_source_ = noise_source;
	used_curve_ = noise_curve;
	noise = noise_field(noise_source, noise_curve);
}

void LayerTables::refresh_image(const MaskFrame &frame) {
	const bool new_pixels = std::exchange(mask_texture.unread, false) || frame.channel != frame_.channel;
	if (!new_pixels && same_area(frame, frame_)) {
		// Neither the pixels nor the area have changed.
		return;
	}
	frame_ = frame;
	const Ref<Texture2D> texture = mask_texture.texture;
	if (new_pixels) {
		pixels_ = texture.is_valid() ? channel_pixels(texture->get_image(), frame.channel) : ChannelPixels{};
		if (texture.is_valid() && pixels_.values.empty()) {
			pixels_ = channel_pixels(mask_texture_image, frame.channel);
		}
	}
	image_missing = texture.is_valid() && pixels_.values.empty();
	image_status = {};
	if (texture.is_null()) {
		image = nullptr;
		return;
	}
	const auto fresh = std::make_shared<ImageMask>();
	constexpr std::array<std::uint8_t, 1> black{0};
	image_status = image_missing ? fresh->set({1, 1}, black, frame.area, MaskEdge::clamp)
								 : fresh->set(pixels_.size, pixels_.values, frame.area, frame.edge);
	image_status.property = "mask_texture";
	if (image_status.ok()) {
		replace<ImageMask>(image, fresh);
	}
}

} // namespace thicket
