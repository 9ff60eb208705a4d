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
	constexpr std::array<float, 2> end_values{1.0F, 0.0F};
	const auto table = std::make_shared<CurveTable>();
	const Status status = table->set(0.0, distance, end_values);
	return status.ok() ? table : nullptr;
}

} // namespace

void LayerTables::refresh(const MaskFrame &frame, std::uint32_t used_channels, double proximity_distance) {
	refresh_noise();
	const bool new_pixels = std::exchange(mask_texture.must_read, false);
	const bool new_area = !same_area(frame, frame_);
	refresh_image(frame, new_pixels || frame.channel != frame_.channel, new_area);
	refresh_channels(frame, used_channels, new_pixels, new_area);
	frame_ = frame;
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

/// Reads a channel of the mask texture. Returns no pixels if there is no readable image.
ChannelPixels LayerTables::pixels_of(ImageChannel channel) const {
	const Ref<Texture2D> &texture = mask_texture.texture;
	if (texture.is_null()) {
		return {};
	}
	ChannelPixels pixels = channel_pixels(texture->get_image(), channel);
	return pixels.values.empty() ? channel_pixels(mask_texture_image, channel) : pixels;
}

void LayerTables::refresh_channels(
		const MaskFrame &frame, std::uint32_t used_channels, bool new_pixels, bool new_area) {
	for (std::size_t channel = 0; channel < channels.size(); ++channel) {
		ChannelPixels &pixels = channel_pixels_[channel];
		if ((used_channels >> channel & 1U) == 0) {
			pixels = {};
			channels[channel] = nullptr;
			continue;
		}
		const bool needs_pixels = new_pixels || pixels.values.empty();
		if (needs_pixels) {
			pixels = pixels_of(static_cast<ImageChannel>(channel));
		}
		if (pixels.values.empty()) {
			channels[channel] = nullptr;
			image_missing = image_missing || mask_texture.texture.is_valid();
		} else if (needs_pixels || new_area) {
			const auto new_mask = std::make_shared<ImageMask>();
			if (new_mask->set(pixels.size, pixels.values, frame.area, frame.edge).ok()) {
				replace<ImageMask>(channels[channel], new_mask);
			}
		}
	}
}

void LayerTables::refresh_image(const MaskFrame &frame, bool new_pixels, bool new_area) {
	if (!new_pixels && !new_area) {
		// Neither the pixels nor the area have changed.
		return;
	}
	const bool is_mask = mask_texture.texture.is_valid() && frame.channel != ImageChannel::none;
	if (new_pixels) {
		pixels_ = is_mask ? pixels_of(frame.channel) : ChannelPixels{};
	}
	image_missing = is_mask && pixels_.values.empty();
	image_status = {};
	if (!is_mask) {
		image = nullptr;
		return;
	}
	const auto new_mask = std::make_shared<ImageMask>();
	constexpr std::array<std::uint8_t, 1> black{0};
	image_status = image_missing ? new_mask->set({1, 1}, black, frame.area, MaskEdge::clamp)
								 : new_mask->set(pixels_.size, pixels_.values, frame.area, frame.edge);
	image_status.property = "mask_texture";
	if (image_status.ok()) {
		replace<ImageMask>(image, new_mask);
	}
}

} // namespace thicket
