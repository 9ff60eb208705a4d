#include "nodes/layer/layer_tables.hpp"

#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Takes over what is new only if it says something else.
template <typename T>
void replace(std::shared_ptr<const T> &r_old, std::shared_ptr<const T> fresh) {
	const bool same = (r_old == nullptr) == (fresh == nullptr) && (fresh == nullptr || *r_old == *fresh);
	if (!same) {
		r_old = std::move(fresh);
	}
}

bool same_area(const MaskFrame &a, const MaskFrame &b) {
	return a.area.min == b.area.min && a.area.max == b.area.max && a.edge == b.edge;
}

std::shared_ptr<const CurveTable> falling_line(double distance) {
	constexpr std::array<float, 2> ends{1.0F, 0.0F};
	const auto table = std::make_shared<CurveTable>();
	const Status status = table->set(0.0, distance, ends);
	return status.ok() ? table : nullptr;
}

} // namespace

bool LayerTables::take(LayerSource source) { return std::exchange(marked_[static_cast<std::size_t>(source)], false); }

void LayerTables::refresh(const LayerResources &resources, const MaskFrame &frame, double proximity_distance) {
	refresh_curve(LayerSource::density_over_height, resources.density_over_height, height_curve);
	refresh_curve(LayerSource::density_over_slope, resources.density_over_slope, slope_curve);
	refresh_curve(LayerSource::scale_curve, resources.scale_curve, scale_curve);
	refresh_noise(resources);
	refresh_proximity(resources, proximity_distance);
	refresh_image(resources.mask_texture, frame);
	if (take(LayerSource::color_gradient)) {
		replace(colors, color_table(resources.color_gradient));
	}
}

void LayerTables::refresh_curve(
		LayerSource source, const Ref<Curve> &p_curve, std::shared_ptr<const CurveTable> &r_table) {
	if (take(source)) {
		replace(r_table, curve_table(p_curve));
	}
}

void LayerTables::refresh_noise(const LayerResources &resources) {
	const std::shared_ptr<const CurveTable> before = noise_curve;
	refresh_curve(LayerSource::noise_curve, resources.noise_curve, noise_curve);
	// Noise cannot be compared; its signal is what tells.
	if (take(LayerSource::noise) || before != noise_curve) {
		noise = noise_field(resources.noise, noise_curve);
	}
}

void LayerTables::refresh_proximity(const LayerResources &resources, double distance) {
	refresh_curve(LayerSource::proximity_curve, resources.proximity_curve, own_proximity_curve);
	replace(proximity_curve, own_proximity_curve ? own_proximity_curve : falling_line(distance));
}

void LayerTables::refresh_image(const Ref<Texture2D> &p_texture, const MaskFrame &frame) {
	// Pixels are asked of the renderer, which waits for it: only where they may be others.
	const bool new_pixels = take(LayerSource::mask_texture) || frame.channel != frame_.channel;
	if (!new_pixels && same_area(frame, frame_)) {
		return;
	}
	frame_ = frame;
	if (new_pixels) {
		pixels_ = p_texture.is_valid() ? channel_pixels(p_texture->get_image(), frame.channel) : ChannelPixels{};
	}
	image_missing = p_texture.is_valid() && pixels_.values.empty();
	image_status = {};
	if (p_texture.is_null()) {
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
