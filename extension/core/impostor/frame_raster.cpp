#include "core/impostor/frame_raster.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

constexpr std::int64_t unit = 256; // Number of corner units per sample.

/// Returns twice the signed area of a triangle in the frame, where y points down. It is positive if
/// the corners are in clockwise order.
template <class Corner>
std::int64_t double_area_of(const Corner &a, const Corner &b, const Corner &c) {
	return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Returns the first sample whose center is at or after a coordinate.
int first_sample(std::int64_t coordinate) { return static_cast<int>((coordinate + unit / 2 - 1) >> 8); }

template <class Value>
Value interpolate(std::span<const Value> values, const std::array<std::size_t, 3> &vertices, glm::vec3 weights) {
	return values[vertices[0]] * weights.x + values[vertices[1]] * weights.y + values[vertices[2]] * weights.z;
}

glm::vec3 unit_vector(glm::vec3 vector) {
	const float length = std::sqrt(glm::dot(vector, vector));
	return length > 0.0F ? vector / length : glm::vec3(0.0F, 1.0F, 0.0F);
}

} // namespace

FrameRaster::FrameRaster(int side) :
		side_(side), samples_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)) {}

void FrameRaster::clear() { std::ranges::fill(samples_, FrameSample()); }

void FrameRaster::draw(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const FrameView &view) {
	pixel_area_ = 2.0 * static_cast<double>(unit * unit) * view.samples * view.samples;
	project(surface.positions, view);
	for (std::size_t first = 0; first + 2 < surface.indices.size(); first += 3) {
		if (Triangle triangle; set_up(surface, first, triangle)) {
			fill(surface, tints, triangle);
		}
	}
}

void FrameRaster::project(std::span<const glm::vec3> positions, const FrameView &view) {
	corners_.clear();
	corners_.reserve(positions.size());
	const float half_side = 0.5F * static_cast<float>(side_);
	const auto to_units = [&](float radii) {
		// The value is clamped, because unused vertices may lie far outside, and not negative,
		// because the cast truncates.
		return static_cast<std::int64_t>(
				std::clamp((radii + 1.0F) * half_side, 0.0F, 2.0F * half_side) * 256.0F + 0.5F);
	};
	for (const glm::vec3 &position : positions) {
		const glm::vec3 offset = (position - view.center) / view.radius;
		corners_.push_back({to_units(glm::dot(offset, view.axes.right)), to_units(-glm::dot(offset, view.axes.up)),
				std::clamp(glm::dot(offset, view.axes.to_viewer), -1.0F, 1.0F)});
	}
}

/// Prepares a triangle. Returns false if it has no area, or if it shows the culled side.
bool FrameRaster::set_up(const ImpostorSurface &surface, std::size_t first_index, Triangle &r_triangle) const {
	std::array<std::size_t, 3> &vertices = r_triangle.vertices;
	std::copy_n(surface.indices.begin() + static_cast<std::ptrdiff_t>(first_index), 3, vertices.begin());
	const std::int64_t area = double_area_of(corners_[vertices[0]], corners_[vertices[1]], corners_[vertices[2]]);
	r_triangle.shows_back = area < 0;
	if (area == 0 || surface.material.culled_side == (r_triangle.shows_back ? CulledSide::back : CulledSide::front)) {
		return false;
	}
	r_triangle.double_area = std::abs(area);
	if (r_triangle.shows_back) {
		std::swap(vertices[1], vertices[2]);
	}
	if (surface.normals.empty()) {
		const glm::vec3 &a = surface.positions[vertices[0]];
		// The normal points to the viewer, because the corners are now clockwise. `shade` flips the
		// normals of back sides.
		const glm::vec3 facing_normal =
				unit_vector(glm::cross(surface.positions[vertices[2]] - a, surface.positions[vertices[1]] - a));
		r_triangle.flat_normal = r_triangle.shows_back ? -facing_normal : facing_normal;
	}
	if (surface.material.texture != nullptr && !surface.uvs.empty()) {
		const glm::vec2 &a = surface.uvs[vertices[0]];
		const glm::dvec2 first_edge = surface.uvs[vertices[1]] - a;
		const glm::dvec2 second_edge = surface.uvs[vertices[2]] - a;
		const glm::dvec2 size = surface.material.texture->size();
		const double texels = std::abs(first_edge.x * second_edge.y - first_edge.y * second_edge.x) * size.x * size.y;
		r_triangle.texture_level =
				surface.material.texture->level_for(texels * pixel_area_ / static_cast<double>(r_triangle.double_area));
	}
	return true;
}

void FrameRaster::fill(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const Triangle &triangle) {
	const std::array<Corner, 3> corners{
			corners_[triangle.vertices[0]], corners_[triangle.vertices[1]], corners_[triangle.vertices[2]]};
	const auto [left, right] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
	const auto [top, bottom] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
	const int first_x = first_sample(left);
	const int end_x = std::min(first_sample(right + 1), side_);
	const int end_y = std::min(first_sample(bottom + 1), side_);
	const float scale = 1.0F / static_cast<float>(triangle.double_area);
	for (int y = first_sample(top); y < end_y; ++y) {
		const Corner center{first_x * unit + unit / 2, y * unit + unit / 2};
		std::int64_t a = double_area_of(corners[1], corners[2], center);
		std::int64_t b = double_area_of(corners[2], corners[0], center);
		std::int64_t c = double_area_of(corners[0], corners[1], center);
		FrameSample *sample = samples_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
				static_cast<std::size_t>(first_x);
		for (int x = first_x; x < end_x; ++x, ++sample) {
			if ((a | b | c) >= 0) { // True if all three numbers are at least 0.
				const glm::vec3 weights =
						glm::vec3(static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)) * scale;
				const float depth =
						corners[0].depth * weights.x + corners[1].depth * weights.y + corners[2].depth * weights.z;
				if (depth > sample->depth) {
					shade(surface, tints, triangle, weights, depth, *sample);
				}
			}
			a -= (corners[2].y - corners[1].y) * unit;
			b -= (corners[0].y - corners[2].y) * unit;
			c -= (corners[1].y - corners[0].y) * unit;
		}
	}
}

/// Writes a sample, unless the surface is transparent at that point.
void FrameRaster::shade(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const Triangle &triangle,
		glm::vec3 weights, float depth, FrameSample &r_sample) const {
	const ImpostorMaterial &material = surface.material;
	glm::vec4 color = interpolate(tints, triangle.vertices, weights);
	if (material.texture != nullptr && !surface.uvs.empty()) {
		color *= material.texture->sample(
				interpolate(std::span(surface.uvs), triangle.vertices, weights), triangle.texture_level);
	}
	if (material.alpha_threshold > 0.0F && color.a < material.alpha_threshold) {
		return;
	}
	const glm::vec3 normal = surface.normals.empty()
			? triangle.flat_normal
			: unit_vector(interpolate(std::span(surface.normals), triangle.vertices, weights));
	// The depth is clamped, because rounding could otherwise make the sample appear empty.
	r_sample = {std::max(depth, -1.0F), glm::vec3(color), triangle.shows_back ? -normal : normal};
}

} // namespace thicket
