#include "nodes/ground/terrain_map.hpp"

#include "nodes/ground/image_posts.hpp"
#include "nodes/ground/map_images.hpp"

#include <godot_cpp/core/object.hpp>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

// HTerrain's IDs for kinds of maps.
constexpr int splat_map = 2;
constexpr int color_map = 3;

constexpr std::int32_t textures_per_splat = WeightMap::max_channels;

/// Selects those of `textures` that belong to a splat map, as channel numbers.
std::vector<std::int32_t> textures_of(std::size_t splat, std::span<const std::int32_t> textures) {
	const auto first = static_cast<std::int32_t>(splat) * textures_per_splat;
	std::vector<std::int32_t> result;
	for (const std::int32_t texture : textures) {
		if (texture >= first && texture < first + textures_per_splat) {
			result.push_back(texture - first);
		}
	}
	return result;
}

/// Reads all maps of a kind. Omits maps that cannot be read.
std::vector<WeightMap> read_maps(const Variant &data, int kind) {
	const Variant count = has_method(data, "get_map_count") ? result_of(data, "get_map_count", {kind}) : Variant();
	std::vector<WeightMap> maps;
	MapImages images;
	for (int index = 0; is_number(count) && index < static_cast<int>(count); ++index) {
		const Ref<Image> image = images.read(data, kind, index);
		WeightMap map;
		if (image.is_valid() && read_weights(image, "map", map).ok()) {
			maps.push_back(std::move(map));
		}
	}
	return maps;
}

} // namespace

bool TerrainMap::copies(std::int64_t map) { return map == splat_map || map == color_map; }

glm::dvec2 TerrainMap::to_map(glm::dvec2 world) const {
	const Vector3 *rows = to_world.basis.rows;
	const double xx = rows[0].x;
	const double xz = rows[0].z;
	const double zx = rows[2].x;
	const double zz = rows[2].z;
	const double x = world.x - to_world.origin.x;
	const double z = world.y - to_world.origin.z;
	const double determinant = xx * zz - xz * zx;
	return {(x * zz - z * xz) / determinant, (z * xx - x * zx) / determinant};
}

float TerrainMap::height_in_world(double height) const {
	return static_cast<float>(to_world.basis.rows[1].y * height + to_world.origin.y);
}

bool TerrainMap::has_ground(glm::dvec2 position) const {
	if (!(position.x >= 0.0 && position.x <= last_post && position.y >= 0.0 && position.y <= last_post)) {
		return false;
	}
	const unsigned alpha = colors.empty() ? 0 : colors.channels_of(std::array{WeightMap::max_channels - 1});
	return alpha == 0 || colors.weight(position / last_post, alpha) >= 0.5F;
}

std::vector<unsigned> TerrainMap::channels_of(std::span<const std::int32_t> textures) const {
	std::vector<unsigned> channels;
	for (std::size_t splat = 0; splat < splats.size(); ++splat) {
		channels.push_back(splats[splat].channels_of(textures_of(splat, textures)));
	}
	return channels;
}

float TerrainMap::weight(glm::dvec2 position, std::span<const unsigned> channels) const {
	float sum = splats.empty() ? 1.0F : 0.0F;
	for (std::size_t splat = 0; splat < channels.size(); ++splat) {
		sum += splats[splat].weight(position / last_post, channels[splat]);
	}
	return std::min(sum, 1.0F);
}

Rect2 TerrainMap::world_rect(const Rect2 &p_rect) const {
	const Vector3 *rows = to_world.basis.rows;
	glm::vec2 min{std::numeric_limits<float>::max()};
	glm::vec2 max{std::numeric_limits<float>::lowest()};
	for (int corner = 0; corner < 4; ++corner) {
		const real_t x = p_rect.position.x + (corner % 2 == 0 ? 0 : p_rect.size.x);
		const real_t z = p_rect.position.y + (corner / 2 == 0 ? 0 : p_rect.size.y);
		const glm::vec2 world{
				rows[0].x * x + rows[0].z * z + to_world.origin.x, rows[2].x * x + rows[2].z * z + to_world.origin.z};
		min = glm::min(min, world);
		max = glm::max(max, world);
	}
	return Rect2(min.x, min.y, max.x - min.x, max.y - min.y);
}

bool has_method(const Variant &p_object, const StringName &p_method) {
	const Object *object = p_object.get_validated_object();
	return object != nullptr && object->has_method(p_method);
}

Variant result_of(const Variant &p_object, const StringName &p_method, std::initializer_list<Variant> p_arguments) {
	std::vector<const Variant *> arguments;
	for (const Variant &argument : p_arguments) {
		arguments.push_back(&argument);
	}
	Variant result;
	GDExtensionCallError error{};
	Variant object(p_object);
	object.callp(p_method, arguments.data(), static_cast<int>(arguments.size()), result, error);
	return error.error == GDEXTENSION_CALL_OK ? result : Variant();
}

bool is_number(const Variant &p_value) {
	return p_value.get_type() == Variant::FLOAT || p_value.get_type() == Variant::INT;
}

std::shared_ptr<const TerrainMap> read_map(const Variant &p_node, const Variant &p_data) {
	const Variant transform = result_of(p_node, "get_internal_transform");
	const Variant resolution = result_of(p_data, "get_resolution");
	if (transform.get_type() != Variant::TRANSFORM3D || !is_number(resolution) ||
			static_cast<double>(resolution) < 2.0) {
		return nullptr;
	}
	auto map = std::make_shared<TerrainMap>();
	map->to_world = static_cast<Transform3D>(transform);
	map->last_post = static_cast<double>(resolution) - 1.0;
	if (has_method(p_data, "get_image")) {
		map->splats = read_maps(p_data, splat_map);
		std::vector<WeightMap> colors = read_maps(p_data, color_map);
		if (!colors.empty()) {
			map->colors = std::move(colors.front());
		}
	}
	return map;
}

} // namespace thicket
