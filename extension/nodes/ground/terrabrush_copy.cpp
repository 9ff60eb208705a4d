// This file copies the ground of TerraBrush (github.com/spimort/TerraBrush), in the versions that
// are written in C++. TerraBrush computes the positions of its height samples in
// src/misc/zone_utils.cpp and draws them in
// demo/addons/terrabrush/Resources/Shaders/zones_shader_include.gdshaderinc.

#include "nodes/common/convert.hpp"
#include "nodes/ground/region_copy.hpp"
#include "nodes/ground/shared_pixels.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/vector2i.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

using Location = std::pair<int, int>;

/// A pixel of TerraBrush's heightmap: the height, and a number above 0 for a hole.
struct Pixel {
	float height;
	float hole;
};

/// The values that determine the positions of height samples.
struct Layout {
	int zone_side = 0; ///< TerraBrush.zonesSize: neighboring zones begin zone_side - 1 meters apart.
	int posts = 0;     ///< The number of height samples along each edge of a zone, including both ends.
	glm::dvec3 center{0.0};

	double spacing() const { return (zone_side - 1.0) / (posts - 1.0); }
	glm::dvec3 origin() const { return center - glm::dvec3(0.5 * (zone_side - 1), 0.0, 0.5 * (zone_side - 1)); }
	bool operator==(const Layout &) const = default;
};

/// The pixels of a zone, shared with its image. TerraBrush copies the bytes before it edits them,
/// so a zone with the same pointer has not changed.
struct Zone {
	PackedByteArray bytes;

	const Pixel *pixels() const { return reinterpret_cast<const Pixel *>(bytes.ptr()); }
	bool operator==(const Zone &other) const { return bytes.ptr() == other.bytes.ptr(); }
};

using Zones = std::map<Location, Zone>;

class TerraBrushCopy final : public RegionCopy {
public:
	TerraBrushCopy(RegionField field, const Layout &layout, Zones zones) :
			RegionCopy(std::move(field), layout.origin(), {}), layout_(layout), zones_(std::move(zones)) {}

	GroundPlugin plugin() const override { return GroundPlugin::terrabrush; }
	bool has_textures() const override { return false; }
	bool is_outdated(const Variant &p_node) const override;

	String description() const override {
		return vformat("TerraBrush, copied: %d zones of %d x %d vertices, %s m apart",
				static_cast<int64_t>(zones_.size()), layout_.posts, layout_.posts, layout_.spacing());
	}

	String remark() const override {
		return zones_.empty() ? String("has no zones: there is no ground yet.") : String();
	}

	const Layout &layout() const { return layout_; }
	const Zones &zones() const { return zones_; }

private:
	Layout layout_;
	Zones zones_;
};

/// Reads the zones of a node, except for those that have no heightmap yet. Returns false with a
/// reason if the node has no terrain, or if its zones are not as in known versions of TerraBrush.
bool read_zones(const Variant &p_node, Layout &r_layout, Zones &r_zones, String &r_refusal) {
	const Variant side = result_of(p_node, "get_zonesSize");
	const Variant center = result_of(p_node, "get_global_position");
	const Variant zone_list = result_of(result_of(p_node, "get_terrainZones"), "get_zones");
	if (!is_number(side) || static_cast<double>(side) < 2.0 || center.get_type() != Variant::VECTOR3) {
		r_refusal = "has no zonesSize of at least 2";
		return false;
	}
	if (zone_list.get_type() != Variant::ARRAY) {
		r_refusal = "has no terrain yet: press its button to create one";
		return false;
	}
	r_layout = {static_cast<int>(side), 0, to_core(static_cast<Vector3>(center))};
	const Array zones = zone_list;
	for (int64_t i = 0; i < zones.size(); ++i) {
		const Ref<Image> image = image_in(result_of(zones[i], "get_heightMapImage"));
		const Variant location = result_of(zones[i], "get_zonePosition");
		if (image.is_null() || location.get_type() != Variant::VECTOR2I) {
			continue;
		}
		const int posts = image->get_width();
		r_layout.posts = r_layout.posts == 0 ? posts : r_layout.posts;
		if (image->get_format() != Image::FORMAT_RGF || posts != r_layout.posts || image->get_height() != posts ||
				posts < 3) {
			r_refusal = vformat(
					"has a heightmap for its zone at %s that is not square, differs in size from the others, or "
					"does not have the format RGF",
					location);
			return false;
		}
		const Vector2i coordinates = location;
		r_zones[{coordinates.x, coordinates.y}] = {image->get_data()};
	}
	r_layout.posts = std::max(r_layout.posts, 3);
	return true;
}

bool TerraBrushCopy::is_outdated(const Variant &p_node) const {
	Layout layout;
	Zones zones;
	String refusal;
	return !read_zones(p_node, layout, zones, refusal) || layout != layout_ || zones != zones_;
}

/// The zones, up to four, that have height samples in a region. The height of a sample on the
/// border of several zones comes from the zone that begins there, or else from one that ends there.
class ZonesOfRegion {
public:
	ZonesOfRegion(const Zones &zones, int posts, Location region) : posts_(posts) {
		for (int i = 0; i < 4; ++i) {
			const auto zone = zones.find({region.first - i % 2, region.second - i / 2});
			pixels_[static_cast<std::size_t>(i)] = zone != zones.end() ? zone->second.pixels() : nullptr;
		}
	}

	/// Returns the height of a sample, or NAN if the sample is a hole or is in no zone.
	float height(int column, int row) const {
		for (int i = 0; i < 4; ++i) {
			const Pixel *pixels = pixels_[static_cast<std::size_t>(i)];
			const bool ends_here = (i % 2 == 0 || column == 0) && (i / 2 == 0 || row == 0);
			if (pixels != nullptr && ends_here) {
				const int x = i % 2 == 0 ? column : posts_ - 1;
				const int y = i / 2 == 0 ? row : posts_ - 1;
				const Pixel &pixel = pixels[y * posts_ + x];
				return pixel.hole > 0.0F ? std::numeric_limits<float>::quiet_NaN() : pixel.height;
			}
		}
		return std::numeric_limits<float>::quiet_NaN();
	}

private:
	int posts_;
	std::array<const Pixel *, 4> pixels_{};
};

/// Creates the region at a location. Along each edge, a region has one height sample less than a
/// zone, because the last samples of a zone belong to the next region.
FieldRegion make_region(const Zones &zones, const Layout &layout, Location location) {
	const int side = layout.posts - 1;
	const ZonesOfRegion zones_of_region(zones, layout.posts, location);
	auto heights = std::make_shared<std::vector<float>>();
	heights->reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
	for (int row = 0; row < side; ++row) {
		for (int column = 0; column < side; ++column) {
			heights->push_back(zones_of_region.height(column, row));
		}
	}
	FieldRegion region;
	region.location = {location.first, location.second};
	const std::span<const std::uint8_t> bytes(
			reinterpret_cast<const std::uint8_t *>(heights->data()), heights->size() * sizeof(float));
	const Status status = region.heights.set(glm::ivec2(side), sizeof(float), {heights, bytes});
	static_cast<void>(status); // The size is valid.
	return region;
}

/// Returns true if the zone at a location is the same in both maps, or missing in both.
bool is_same_zone(const Zones &a, const Zones &b, Location location) {
	const auto zone_a = a.find(location);
	const auto zone_b = b.find(location);
	return zone_a == a.end() || zone_b == b.end() ? (zone_a == a.end()) == (zone_b == b.end())
												  : zone_a->second == zone_b->second;
}

/// Creates all regions that contain height samples of the zones. Reuses regions of `before` if all
/// of their zones are unchanged. `before` may be null.
std::vector<FieldRegion> make_regions(const Zones &zones, const Layout &layout, const TerraBrushCopy *before) {
	std::map<Location, bool> reusability; // Maps each region to true if it can be reused.
	for (const auto &[location, zone] : zones) {
		for (const auto &[right, down] : std::array<Location, 4>{{{0, 0}, {1, 0}, {0, 1}, {1, 1}}}) {
			reusability[{location.first + right, location.second + down}] = before != nullptr;
		}
	}
	std::vector<FieldRegion> regions;
	for (auto &[location, is_reusable] : reusability) {
		for (const auto &[left, up] : std::array<Location, 4>{{{0, 0}, {1, 0}, {0, 1}, {1, 1}}}) {
			is_reusable =
					is_reusable && is_same_zone(zones, before->zones(), {location.first - left, location.second - up});
		}
		const FieldRegion *reusable =
				is_reusable ? before->field().region_at({location.first, location.second}) : nullptr;
		regions.push_back(reusable != nullptr ? *reusable : make_region(zones, layout, location));
	}
	return regions;
}

} // namespace

CopyAttempt copy_terrabrush(const Variant &p_node, const GroundCopy *before) {
	CopyAttempt attempt;
	if (!has_method(p_node, "getHeightAtPosition") || !has_method(p_node, "get_terrainZones")) {
		return attempt;
	}
	attempt.plugin = GroundPlugin::terrabrush;
	attempt.data = result_of(p_node, "get_terrainZones");
	Layout layout;
	Zones zones;
	if (!read_zones(p_node, layout, zones, attempt.refusal)) {
		return attempt;
	}
	const auto *previous = before != nullptr && before->plugin() == GroundPlugin::terrabrush
			? static_cast<const TerraBrushCopy *>(before)
			: nullptr;
	previous = previous != nullptr && previous->layout().posts == layout.posts ? previous : nullptr;
	RegionField field;
	const Status status =
			field.set(layout.posts - 1, layout.spacing(), make_regions(zones, layout, previous), AutoPaint());
	if (status.ok()) {
		attempt.copy = std::make_shared<TerraBrushCopy>(std::move(field), layout, std::move(zones));
	} else {
		attempt.refusal = String(("cannot be copied (" + describe(status) + ")").c_str());
	}
	return attempt;
}

} // namespace thicket
