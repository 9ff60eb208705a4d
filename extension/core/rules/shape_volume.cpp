#include "core/rules/shape_volume.hpp"

#include "core/base/floating_point.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

double dot(glm::dvec3 a, glm::dvec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double dot(glm::dvec2 a, glm::dvec2 b) { return a.x * b.x + a.y * b.y; }
double length(glm::dvec2 a) { return std::sqrt(dot(a, a)); }

glm::dvec3 unit(glm::dvec3 a) { return a / std::sqrt(dot(a, a)); }

/// Orthonormalizes axes to double precision (Gram-Schmidt). They must already be orthonormal to
/// 1e-6. The rounding of the engine's axes, which are floats, would displace the border of a large
/// shape by meters.
glm::dmat3 orthonormal(const glm::dmat3 &axes) {
	const glm::dvec3 y = unit(axes[1]); // The up axis comes first, because a cylinder uses only this axis.
	const glm::dvec3 x = unit(axes[0] - y * dot(axes[0], y));
	const glm::dvec3 z = axes[2] - y * dot(axes[2], y);
	return {x, y, unit(z - x * dot(z, x))};
}

/// A cylinder is treated as upright if the sine of its tilt is at most this value. The error of its
/// shadow is then at most half the square of this value.
constexpr double min_lean = 1e-7;

/// Returns the smallest value of `gap` over the directions between the axes x and y, by ternary
/// search. `gap` must have at most one minimum between them. Each round excludes a third of the
/// range, and the error decreases with the square of the remaining range.
template <typename Gap>
double min_gap(Gap gap) {
	constexpr int rounds = 40;
	const auto along = [&](double turn) { // `turn` is 0 at x and 1 at y.
		const glm::dvec2 direction(1.0 - turn, turn);
		return gap(direction / length(direction));
	};
	double smallest = std::min(along(0.0), along(1.0));
	double low = 0.0;
	double high = 1.0;
	for (int i = 0; i < rounds; ++i) {
		const double third = (high - low) / 3.0;
		const double first = along(low + third);
		const double second = along(high - third);
		smallest = std::min({smallest, first, second});
		if (first < second) {
			high -= third;
		} else {
			low += third;
		}
	}
	return smallest;
}

} // namespace

ShapeVolume::ShapeVolume(const Shape &shape) :
		kind_(shape.kind), shadow_(shape.ignore_height), center_(shape.center), half_size_(shape.half_size) {
	if (kind_ == ShapeKind::sphere) {
		return;
	}
	axes_ = orthonormal(shape.axes);
	prepare_shadow();
}

void ShapeVolume::prepare_shadow() {
	if (kind_ == ShapeKind::box) {
		// The shadow is a zonogon, a polygon with pairs of parallel sides. Its sides are parallel
		// to the shadows of the edges. Each pair's distance from the center is the sum of the
		// projections of the other edges.
		const auto shadow = [&](int i) {
			return glm::dvec2(axes_[i].x, axes_[i].z);
		};
		for (int i = 0; i < 3; ++i) {
			const double width = length(shadow(i));
			if (width > 0.0) { // A vertical edge has no shadow and is skipped.
				const glm::dvec2 normal = glm::dvec2(-shadow(i).y, shadow(i).x) / width;
				const int j = (i + 1) % 3;
				const int k = (i + 2) % 3;
				sides_[static_cast<std::size_t>(i)] = {normal,
						std::abs(dot(normal, shadow(j))) * half_size_[j] +
								std::abs(dot(normal, shadow(k))) * half_size_[k]};
			}
		}
		return;
	}
	const glm::dvec2 lean(axes_[1].x, axes_[1].z);
	const double sine = length(lean);
	if (sine > min_lean) {
		lean_ = lean / sine;
		lean_length_ = sine * half_size_.y;
		upright_ = std::abs(axes_[1].y);
	}
}

double ShapeVolume::depth(glm::dvec3 position) const {
	const glm::dvec3 offset = position - center_;
	const glm::dvec2 flat(offset.x, offset.z);
	if (kind_ == ShapeKind::sphere) {
		return half_size_.x - (shadow_ ? length(flat) : std::sqrt(dot(offset, offset)));
	}
	if (kind_ == ShapeKind::box) {
		return shadow_ ? box_shadow_depth(flat) : box_depth(offset);
	}
	return shadow_ ? cylinder_shadow_depth(flat) : cylinder_depth(offset);
}

double ShapeVolume::box_depth(glm::dvec3 offset) const {
	return std::min({half_size_.x - std::abs(dot(axes_[0], offset)), half_size_.y - std::abs(dot(axes_[1], offset)),
			half_size_.z - std::abs(dot(axes_[2], offset))});
}

double ShapeVolume::cylinder_depth(glm::dvec3 offset) const {
	const double along = dot(axes_[1], offset);
	const glm::dvec3 horizontal = offset - axes_[1] * along;
	return std::min(half_size_.y - std::abs(along), half_size_.x - std::sqrt(dot(horizontal, horizontal)));
}

double ShapeVolume::box_shadow_depth(glm::dvec2 offset) const {
	double result = max_shape_coordinate;
	for (const Sides &sides : sides_) {
		if (sides.normal != glm::dvec2(0.0)) {
			result = std::min(result, sides.distance - std::abs(dot(sides.normal, offset)));
		}
	}
	return result;
}

double ShapeVolume::cylinder_shadow_depth(glm::dvec2 offset) const {
	const double radius = half_size_.x;
	if (lean_length_ == 0.0) {
		return radius - length(offset);
	}
	// The shadow is an ellipse swept along the direction in which the cylinder leans. The distance
	// from inside to a convex border is the distance to the nearest tangent, which faces the
	// quadrant that contains the position.
	const glm::dvec2 position(std::abs(dot(lean_, offset)), std::abs(lean_.x * offset.y - lean_.y * offset.x));
	return min_gap([&](glm::dvec2 normal) {
		const glm::dvec2 ellipse(normal.x * radius * upright_, normal.y * radius);
		return normal.x * lean_length_ + length(ellipse) - dot(normal, position);
	});
}

glm::dvec2 ShapeVolume::reach() const {
	if (kind_ == ShapeKind::sphere) {
		return glm::dvec2(half_size_.x);
	}
	const auto along = [&](int axis) {
		if (kind_ == ShapeKind::box) {
			return std::abs(axes_[0][axis]) * half_size_.x + std::abs(axes_[1][axis]) * half_size_.y +
					std::abs(axes_[2][axis]) * half_size_.z;
		}
		const double lean = axes_[1][axis];
		return std::abs(lean) * half_size_.y + half_size_.x * std::sqrt(std::max(0.0, 1.0 - lean * lean));
	};
	return {along(0), along(2)};
}

} // namespace thicket
