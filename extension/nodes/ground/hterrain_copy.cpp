// This file copies the ground of HTerrain (github.com/Zylann/godot_heightmap_plugin), versions 1.7,
// 1.8 and later. HTerrain defines this ground in hterrain.gd and hterrain_data.gd.

#include "nodes/ground/ground_copy.hpp"

#include "core/terrain/map_field.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/ground/map_images.hpp"
#include "nodes/ground/shared_pixels.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

// HTerrain's IDs for kinds of maps.
constexpr int height_map = 0;
constexpr int splat_map = 2;
constexpr int color_map = 3;
constexpr int splat_index_map = 6;
constexpr int splat_weight_map = 7;

constexpr int max_splats = 16;

/// The number of height samples in each direction that affect the ground at a position, because of
/// interpolation and slopes.
constexpr int post_margin = 2;

std::optional<PostFormat> post_format(Image::Format format) {
	switch (format) {
		case Image::FORMAT_RF: return PostFormat::float32;
		case Image::FORMAT_RH: return PostFormat::float16;
		case Image::FORMAT_RGB8: return PostFormat::rgb8;
		default: return {};
	}
}

MapTransform map_transform_of(const Transform3D &p_transform) {
	const Vector3 *rows = p_transform.basis.rows;
	MapTransform map_transform;
	map_transform.to_world = glm::dmat2(rows[0].x, rows[2].x, rows[0].z, rows[2].z);
	map_transform.origin = to_core(p_transform.origin);
	map_transform.height_scale = rows[1].y;
	return map_transform;
}

/// Returns true if the map is not upright, except for rounding.
bool is_tilted(const Transform3D &p_transform) {
	const Vector3 *rows = p_transform.basis.rows;
	constexpr real_t tolerance = 1e-4F;
	const auto is_small = [&](real_t value, real_t reference) {
		return std::abs(value) <= tolerance * std::abs(reference);
	};
	const real_t horizontal = std::abs(rows[0].x) + std::abs(rows[0].z) + std::abs(rows[2].x) + std::abs(rows[2].z);
	return !(is_small(rows[0].y, rows[1].y) && is_small(rows[2].y, rows[1].y) && is_small(rows[1].x, horizontal) &&
			is_small(rows[1].z, horizontal));
}

class HTerrainCopy final : public GroundCopy {
public:
	HTerrainCopy(MapField field, bool tilted, MapImages images) :
			field_(std::move(field)), is_tilted_(tilted), images_(std::move(images)) {}

	GroundPlugin plugin() const override { return GroundPlugin::hterrain; }

	std::shared_ptr<const Terrain> at_offset(glm::dvec3 offset) const override {
		return std::make_shared<MapField>(field_.at_offset(offset));
	}

	bool has_textures() const override { return field_.layers().has_textures(); }

	String description() const override {
		const glm::ivec2 posts = field_.layers().heights.size();
		const char *const textures = !field_.layers().indices.empty() ? "textures by index"
				: field_.layers().splats.empty()                      ? "no textures"
																	  : "textures by splat maps";
		return vformat("HTerrain, copied: %d x %d vertices, %s", posts.x, posts.y, String(textures));
	}

	String remark() const override {
		if (images_.lacks_pixels()) {
			return "has a color map or texture maps without pixels, so its holes or textures are not known: import "
				   "these maps as Image, or keep them in the export.";
		}
		return is_tilted_
				? String("is tilted, so its copied ground is wrong. Rotate the node about the vertical axis only.")
				: String();
	}

	GroundChanges changes_since(const GroundCopy &before, glm::dvec3 shift) const override;
	std::shared_ptr<const GroundCopy> with_edits(const Variant &p_data, std::span<const MapEdit> edits) const override;

	/// Returns the images to reuse in the next copy.
	MapImages next_images() const { return images_.for_next_copy(); }

private:
	bool same_transform(const HTerrainCopy &before, glm::dvec3 shift) const;
	Rect2 area_of(const PixelRect &rect) const;
	static PixelGrid *layer_of(MapLayers &layers, const MapEdit &edit);

	MapField field_;
	bool is_tilted_;
	MapImages images_;
};

/// Returns true if the map has the same transform in the world. A node that has moved with the
/// engine's origin is considered unmoved. Tolerates float rounding.
bool HTerrainCopy::same_transform(const HTerrainCopy &before, glm::dvec3 shift) const {
	MapTransform transform = field_.transform();
	const MapTransform &other_transform = before.field_.transform();
	const double max_distance = std::max(glm::length(transform.origin), glm::length(other_transform.origin));
	if (!(glm::length(transform.origin + shift - other_transform.origin) <=
				4.0 * max_distance * std::numeric_limits<float>::epsilon())) {
		return false;
	}
	transform.origin = other_transform.origin;
	return transform == other_transform;
}

/// Returns the bounding rectangle, in the engine's x and z, of the ground that the pixels in `rect`
/// affect.
Rect2 HTerrainCopy::area_of(const PixelRect &rect) const {
	const MapTransform &map_transform = field_.transform();
	glm::dvec2 min{std::numeric_limits<double>::max()};
	glm::dvec2 max{std::numeric_limits<double>::lowest()};
	for (int corner = 0; corner < 4; ++corner) {
		const glm::dvec2 post{corner % 2 == 0 ? rect.min.x - post_margin : rect.max.x - 1 + post_margin,
				corner / 2 == 0 ? rect.min.y - post_margin : rect.max.y - 1 + post_margin};
		const glm::dvec2 world =
				map_transform.to_world * post + glm::dvec2(map_transform.origin.x, map_transform.origin.z);
		min = glm::min(min, world);
		max = glm::max(max, world);
	}
	return to_engine(Rect{min, max});
}

GroundChanges HTerrainCopy::changes_since(const GroundCopy &before, glm::dvec3 shift) const {
	GroundChanges changes;
	const auto *const other = before.plugin() == plugin() ? static_cast<const HTerrainCopy *>(&before) : nullptr;
	if (other == nullptr) {
		changes.whole_ground = true;
		return changes;
	}
	const MapLayers &layers = field_.layers();
	const MapLayers &other_layers = other->field_.layers();
	const auto same_layout = [](const PixelGrid &a, const PixelGrid &b) {
		return a.size() == b.size() && a.pixel_bytes() == b.pixel_bytes();
	};
	changes.whole_ground = !same_transform(*other, shift) || layers.format != other_layers.format ||
			!same_layout(layers.heights, other_layers.heights) || !same_layout(layers.colors, other_layers.colors) ||
			!same_layout(layers.indices, other_layers.indices) || !same_layout(layers.weights, other_layers.weights) ||
			layers.splats.size() != other_layers.splats.size();
	if (changes.whole_ground) {
		return changes;
	}
	const auto add = [&](const PixelGrid &a, const PixelGrid &b) {
		if (const PixelRect rect = a.difference(b); !rect.empty()) {
			changes.areas.push_back(area_of(rect));
		}
	};
	add(layers.heights, other_layers.heights);
	add(layers.colors, other_layers.colors);
	add(layers.indices, other_layers.indices);
	add(layers.weights, other_layers.weights);
	for (std::size_t splat = 0; splat < layers.splats.size(); ++splat) {
		add(layers.splats[splat], other_layers.splats[splat]);
	}
	return changes;
}

/// Returns the layer that is a copy of the edited map, or null.
PixelGrid *HTerrainCopy::layer_of(MapLayers &layers, const MapEdit &edit) {
	const auto non_empty = [](PixelGrid &layer) {
		return layer.empty() ? nullptr : &layer;
	};
	switch (edit.map) {
		case height_map: return &layers.heights;
		case color_map: return non_empty(layers.colors);
		case splat_index_map: return non_empty(layers.indices);
		case splat_weight_map: return non_empty(layers.weights);
		case splat_map:
			return edit.index >= 0 && edit.index < static_cast<std::int64_t>(layers.splats.size())
					? &layers.splats[static_cast<std::size_t>(edit.index)]
					: nullptr;
		default: return nullptr;
	}
}

/// Splits each edit of all maps of a kind into one edit per map.
std::vector<MapEdit> split_by_map(std::span<const MapEdit> edits, std::size_t splats) {
	std::vector<MapEdit> result;
	for (const MapEdit &edit : edits) {
		if (edit.index >= 0) {
			result.push_back(edit);
			continue;
		}
		const std::size_t count = edit.map == splat_map ? splats : 1;
		for (std::size_t index = 0; index < count; ++index) {
			result.push_back({edit.map, static_cast<std::int64_t>(index), edit.rect});
		}
	}
	return result;
}

std::shared_ptr<const GroundCopy> HTerrainCopy::with_edits(
		const Variant &p_data, std::span<const MapEdit> edits) const {
	MapLayers layers = field_.layers();
	MapImages images = images_;
	for (const MapEdit &edit : split_by_map(edits, layers.splats.size())) {
		PixelGrid *layer = layer_of(layers, edit);
		if (layer == nullptr) {
			continue; // Maps such as normals and details are not copied.
		}
		const Ref<Image> image = images.read(p_data, static_cast<int>(edit.map), static_cast<int>(edit.index));
		const glm::ivec2 first{edit.rect.position.x, edit.rect.position.y};
		const PixelRect rect{
				glm::max(first, 0), glm::min(first + glm::ivec2(edit.rect.size.x, edit.rect.size.y), layer->size())};
		if (image.is_null() || (!rect.empty() && !patch_pixels(image, rect, *layer))) {
			return nullptr;
		}
	}
	MapField field;
	if (!field.set(field_.transform(), layers).ok()) {
		return nullptr;
	}
	// The new copy shares everything else with the previous one.
	return std::make_shared<HTerrainCopy>(std::move(field), is_tilted_, std::move(images));
}

/// Reads the height map. Returns false with a reason if it is missing or cannot be copied.
bool read_heights(const Variant &p_data, MapImages &images, MapLayers &r_layers, String &r_refusal) {
	const Ref<Image> heights = images.read(p_data, height_map, 0);
	const Variant resolution = result_of(p_data, "get_resolution");
	if (heights.is_null()) {
		r_refusal = "has no height map";
		return false;
	}
	const std::optional<PostFormat> format = post_format(heights->get_format());
	if (!format || !share_pixels(heights, bytes_of(*format), r_layers.heights)) {
		r_refusal = vformat("has a height map in a format other than RF, RH and RGB8 (Image.Format %d)",
				static_cast<int64_t>(heights->get_format()));
		return false;
	}
	const glm::ivec2 size = r_layers.heights.size();
	if (!is_number(resolution) || size != glm::ivec2(static_cast<int>(resolution))) {
		r_refusal =
				vformat("has a height map of %d x %d pixels, but a get_resolution() of %s", size.x, size.y, resolution);
		return false;
	}
	r_layers.format = *format;
	return true;
}

/// Reads the texture maps: textures by index, or all splat maps up to the first that is missing.
void read_textures(const Variant &p_node, const Variant &p_data, MapImages &images, MapLayers &r_layers) {
	if (uses_indexed_textures(p_node)) {
		const Ref<Image> indices = images.read(p_data, splat_index_map, 0);
		const Ref<Image> weights = images.read(p_data, splat_weight_map, 0);
		if (indices.is_valid() && weights.is_valid() &&
				!(share_pixels_as(indices, Image::FORMAT_RGB8, 3, r_layers.indices) &&
						share_pixels_as(weights, Image::FORMAT_RG8, 2, r_layers.weights))) {
			r_layers.indices = {};
			r_layers.weights = {};
		}
		return;
	}
	for (int index = 0; index < max_splats; ++index) {
		const Ref<Image> splat = images.read(p_data, splat_map, index);
		PixelGrid pixels;
		if (splat.is_null() || !share_pixels_as(splat, Image::FORMAT_RGBA8, 4, pixels)) {
			return;
		}
		r_layers.splats.push_back(std::move(pixels));
	}
}

} // namespace

/// Needs two methods, because each alone may return an outdated result. In HTerrain 1.8,
/// get_shader_type() is up to date immediately, but is_using_indexed_splatmap() only once the
/// shader is in use. With a custom shader, only is_using_indexed_splatmap() works.
bool uses_indexed_textures(const Variant &p_node) {
	const Variant type = has_method(p_node, "get_shader_type") ? result_of(p_node, "get_shader_type") : Variant();
	if (type.get_type() == Variant::STRING && static_cast<String>(type) == "Array") {
		return true;
	}
	const Variant is_indexed = has_method(p_node, "is_using_indexed_splatmap")
			? result_of(p_node, "is_using_indexed_splatmap")
			: Variant();
	return is_indexed.get_type() == Variant::BOOL && static_cast<bool>(is_indexed);
}

CopyAttempt copy_hterrain(const Variant &p_node, const GroundCopy *before) {
	CopyAttempt attempt;
	if (!has_method(p_node, "get_data") || !has_method(p_node, "get_internal_transform")) {
		return attempt;
	}
	attempt.plugin = GroundPlugin::hterrain;
	attempt.data = result_of(p_node, "get_data");
	for (const char *const method : {"get_resolution", "get_map_count", "get_image"}) {
		if (!has_method(attempt.data, method)) {
			attempt.refusal = attempt.data.get_validated_object() == nullptr
					? String("has no data yet")
					: vformat("has data without %s()", String(method));
			return attempt;
		}
	}
	MapImages images;
	if (before != nullptr && before->plugin() == GroundPlugin::hterrain) {
		images = static_cast<const HTerrainCopy *>(before)->next_images();
	}
	MapLayers layers;
	if (!read_heights(attempt.data, images, layers, attempt.refusal)) {
		return attempt;
	}
	if (const Ref<Image> colors = images.read(attempt.data, color_map, 0); colors.is_valid()) {
		share_pixels_as(colors, Image::FORMAT_RGBA8, 4, layers.colors);
	}
	read_textures(p_node, attempt.data, images, layers);
	const Variant transform = result_of(p_node, "get_internal_transform");
	if (transform.get_type() != Variant::TRANSFORM3D) {
		attempt.refusal = "has a get_internal_transform() that does not return a Transform3D";
		return attempt;
	}
	const Transform3D to_world = transform;
	MapField field;
	if (const Status status = field.set(map_transform_of(to_world), layers); !status.ok()) {
		attempt.refusal = String(("cannot be copied (" + describe(status) + ")").c_str());
		return attempt;
	}
	attempt.copy = std::make_shared<HTerrainCopy>(std::move(field), is_tilted(to_world), std::move(images));
	return attempt;
}

} // namespace thicket
