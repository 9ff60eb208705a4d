#include "core/terrain/map_field.hpp"

#include "core/base/bilinear.hpp"
#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/terrain/grid_surface.hpp"
#include "core/terrain/smooth_patch.hpp"

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace thicket {

namespace {

constexpr int textures_per_splat = 4;

Status check_layer(const char *name, const PixelGrid &layer, glm::ivec2 posts) {
	if (layer.empty() || layer.size() == posts) {
		return {};
	}
	return layer.size().x != posts.x
			? Status::wrong_size(name, layer.size().x, exactly(posts.x, "columns, like the height map"))
			: Status::wrong_size(name, layer.size().y, exactly(posts.y, "rows, like the height map"));
}

Status check(const MapLayers &layers) {
	const glm::ivec2 posts = layers.heights.size();
	if (posts.x < 2 || posts.y < 2) {
		return Status::wrong_size("height map", std::min(posts.x, posts.y), at_least(2, "height samples on each axis"));
	}
	Status status = first_failure(check_layer("color map", layers.colors, posts),
			check_layer("splat index map", layers.indices, posts),
			check_layer("splat weight map", layers.weights, posts));
	for (const PixelGrid &splat : layers.splats) {
		status = first_failure(status, check_layer("splat map", splat, posts));
	}
	if (status.ok() && layers.indices.empty() != layers.weights.empty()) {
		return {ErrorCode::missing, layers.indices.empty() ? "splat index map" : "splat weight map", 0.0};
	}
	return status;
}

Status check(const MapTransform &transform) {
	const double area = std::abs(glm::determinant(transform.to_world));
	return first_failure(check_range("area per height sample", area, MapField::min_area, 1e12),
			check_range("x of the map's origin", transform.origin.x, -1e12, 1e12),
			check_range("y of the map's origin", transform.origin.y, -1e12, 1e12),
			check_range("z of the map's origin", transform.origin.z, -1e12, 1e12),
			check_range("height scale of the map", transform.height_scale, -1e6, 1e6));
}

/// Returns, for each splat map, the channels that belong to `textures`, one bit each.
std::vector<unsigned> channels_of(std::span<const std::int32_t> textures, std::size_t splats) {
	std::vector<unsigned> channels(splats);
	for (const std::int32_t texture : textures) {
		const std::int32_t splat = texture / textures_per_splat;
		if (texture >= 0 && static_cast<std::size_t>(splat) < splats) {
			channels[static_cast<std::size_t>(splat)] |= 1u << static_cast<unsigned>(texture % textures_per_splat);
		}
	}
	return channels;
}

/// Interpolates between the values of the four height samples of a patch.
template <class ValueOf>
double interpolated(glm::ivec2 patch, glm::dvec2 part, ValueOf value_of) {
	return bilinear(value_of(patch.x, patch.y), value_of(patch.x + 1, patch.y), value_of(patch.x, patch.y + 1),
			value_of(patch.x + 1, patch.y + 1), part.x, part.y);
}

} // namespace

Status MapField::set(const MapTransform &transform, const MapLayers &layers) {
	if (const Status status = first_failure(check(transform), check(layers)); !status.ok()) {
		return status;
	}
	return guarded("splat maps", static_cast<double>(layers.splats.size()), [&] {
		MapField next;
		next.layers_ = layers;
		next.transform_ = transform;
		next.to_map_ = glm::inverse(transform.to_world);
		next.make_surface();
		*this = std::move(next);
	});
}

MapField MapField::at_offset(glm::dvec3 offset) const {
	MapField field = *this;
	field.transform_.origin += offset;
	field.make_surface();
	return field;
}

/// The height samples of the map as a grid of triangles.
struct MapField::Grid {
	MapTransform frame;
	glm::dmat2 to_map;
	PixelGrid posts;
	PixelGrid colors;
	PostFormat format;
	bool mirrored;

	glm::ivec2 patches() const { return posts.size() - 1; }
	glm::dvec2 post_position(glm::ivec2 post) const {
		return glm::dvec2(frame.origin.x, frame.origin.z) + frame.to_world * glm::dvec2(post);
	}
	PostRange range(const Box3 &box) const {
		constexpr double infinity = std::numeric_limits<double>::infinity();
		PostRange range{glm::dvec2(infinity), glm::dvec2(-infinity)};
		for (int corner = 0; corner < 4; ++corner) {
			const glm::dvec2 at{corner % 2 == 0 ? box.min.x : box.max.x, corner / 2 == 0 ? box.min.z : box.max.z};
			const glm::dvec2 post = to_map * (at - glm::dvec2(frame.origin.x, frame.origin.z));
			range = {glm::min(range.min, post), glm::max(range.max, post)};
		}
		return range;
	}
	bool heights(glm::ivec2 patch, std::array<double, 4> &r_heights) const {
		bool found = true;
		for (int i = 0; i < 4 && found; ++i) {
			const glm::ivec2 post = patch + glm::ivec2(i % 2, i / 2);
			const double height = post_height(posts.pixel(post.x, post.y), format);
			r_heights[static_cast<std::size_t>(i)] = frame.origin.y + frame.height_scale * height;
			found = std::isfinite(height) && (colors.empty() || colors.pixel(post.x, post.y)[3] >= 128);
		}
		return found;
	}
};

void MapField::make_surface() {
	surface_ = std::make_shared<const GridSurface<Grid>>(Grid{transform_, to_map_, layers_.heights, layers_.colors,
			layers_.format, glm::determinant(transform_.to_world) < 0.0});
}

bool MapField::find_patch(glm::dvec2 position, glm::ivec2 &r_patch, glm::dvec2 &r_part) const {
	const glm::dvec2 at = to_map_ * (position - glm::dvec2(transform_.origin.x, transform_.origin.z));
	const glm::dvec2 last(posts() - 1);
	if (!(at.x >= 0.0 && at.y >= 0.0 && at.x <= last.x && at.y <= last.y)) {
		return false; // Also returned for NAN, because the comparison is then false.
	}
	r_patch = {std::min(static_cast<int>(at.x), posts().x - 2), std::min(static_cast<int>(at.y), posts().y - 2)};
	r_part = at - glm::dvec2(r_patch);
	return true;
}

Ground MapField::ground_at(glm::dvec2 position) const {
	glm::ivec2 patch{0};
	glm::dvec2 part{0.0};
	if (layers_.heights.empty() || !find_patch(position, patch, part)) {
		return {};
	}
	const auto alpha = [this](int column, int row) -> double {
		return layers_.colors.pixel(column, row)[3];
	};
	if (!layers_.colors.empty() && interpolated(patch, part, alpha) < 127.5) {
		return {};
	}
	const SmoothPatch surface = smooth_patch<true>(posts(), patch, part,
			[this](int column, int row) { return post_height(layers_.heights.pixel(column, row), layers_.format); });
	if (!std::isfinite(surface.height)) {
		return {};
	}
	const glm::dvec2 gradient = glm::transpose(to_map_) * surface.gradient * transform_.height_scale;
	const double to_unit = 1.0 / std::sqrt(gradient.x * gradient.x + gradient.y * gradient.y + 1.0);
	return {
			static_cast<float>(transform_.origin.y + transform_.height_scale * surface.height),
			{
					static_cast<float>(-gradient.x * to_unit),
					static_cast<float>(to_unit),
					static_cast<float>(-gradient.y * to_unit),
			},
	};
}

Status MapField::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_ground[i] = ground_at(positions[i]);
	}
	return {};
}

double MapField::splat_at(int column, int row, std::span<const unsigned> channels) const {
	int sum = 0;
	for (std::size_t splat = 0; splat < channels.size(); ++splat) {
		for (unsigned channel = 0; channels[splat] >> channel != 0; ++channel) {
			if ((channels[splat] >> channel & 1u) != 0) {
				sum += layers_.splats[splat].pixel(column, row)[channel];
			}
		}
	}
	return std::min(sum / 255.0, 1.0);
}

double MapField::indexed_at(int column, int row, std::span<const std::int32_t> textures) const {
	const std::uint8_t *index = layers_.indices.pixel(column, row);
	const std::uint8_t *weight = layers_.weights.pixel(column, row);
	const std::array<int, 3> parts{weight[0], weight[1], std::max(255 - weight[0] - weight[1], 0)};
	int sum = 0;
	for (std::size_t i = 0; i < parts.size(); ++i) {
		if (std::ranges::find(textures, std::int32_t{index[i]}) != textures.end()) {
			sum += parts[i];
		}
	}
	return std::min(sum / 255.0, 1.0);
}

Status MapField::weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	if (!layers_.has_textures()) {
		return {};
	}
	return guarded("splat maps", static_cast<double>(layers_.splats.size()), [&] {
		const std::vector<unsigned> channels = channels_of(textures, layers_.splats.size());
		const auto fraction = [&](int column, int row) {
			return layers_.indices.empty() ? splat_at(column, row, channels) : indexed_at(column, row, textures);
		};
		for (std::size_t i = 0; i < positions.size(); ++i) {
			glm::ivec2 patch{0};
			glm::dvec2 part{0.0};
			const bool inside = find_patch(positions[i], patch, part);
			r_ground[i].weight = inside ? static_cast<float>(interpolated(patch, part, fraction)) : 0.0F;
		}
	});
}

} // namespace thicket
