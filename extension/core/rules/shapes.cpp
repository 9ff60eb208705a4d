#include "core/rules/shapes.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

bool flat(const Shape &shape) { return shape.kind == ShapeKind::polygon || shape.kind == ShapeKind::path; }

double influence_at(double depth, double falloff) {
	if (!(depth > 0.0)) {
		return 0.0;
	}
	return depth < falloff ? depth / falloff : 1.0;
}

} // namespace

Status ShapeSet::set(std::vector<Shape> shapes) {
	for (const Shape &shape : shapes) {
		if (const Status status = validate(shape); !status.ok()) {
			return status;
		}
	}
	return guarded("shapes", static_cast<double>(shapes.size()), [&] {
		std::vector<Prepared> prepared(shapes.size());
		for (std::size_t i = 0; i < shapes.size(); ++i) {
			const Shape &shape = shapes[i];
			prepared[i].bounds = bounds(shape);
			if (shape.planet.exists()) {
				prepared[i].map = PlanetMap(shape.planet, shape.center);
			}
			if (flat(shape)) {
				prepared[i].outline.set(shape.outline, shape.kind == ShapeKind::polygon);
			} else {
				const PlanetMap &map = prepared[i].map;
				prepared[i].volume = ShapeVolume(map.exists() ? rotated_upright(shape, map) : shape);
			}
		}
		includes_ = std::ranges::any_of(shapes, [](const Shape &shape) { return !shape.exclude; });
		shapes_ = std::move(shapes);
		prepared_ = std::move(prepared);
	});
}

Status ShapeSet::find_nearby(const Rect &area, std::vector<std::uint32_t> &r_nearby_shapes) const {
	r_nearby_shapes.clear();
	return guarded_answer("shapes", static_cast<double>(prepared_.size()), r_nearby_shapes, [&] {
		for (std::size_t i = 0; i < prepared_.size(); ++i) {
			const Rect &reach = prepared_[i].bounds;
			if (area.min.x <= reach.max.x && reach.min.x <= area.max.x && area.min.y <= reach.max.y &&
					reach.min.y <= area.max.y) {
				r_nearby_shapes.push_back(static_cast<std::uint32_t>(i));
			}
		}
	});
}

ShapeEffect ShapeSet::effect(std::span<const std::uint32_t> nearby_shapes, glm::dvec3 position) const {
	ShapeEffect effect{.included = includes_ ? 0.0 : 1.0};
	if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z)) {
		effect.included = 0.0;
		return effect;
	}
	for (const std::uint32_t index : nearby_shapes) {
		const bool exclude = shapes_[index].exclude;
		double &strongest = exclude ? effect.excluded : effect.included;
		if (strongest >= 1.0) {
			// An influence of 1 cannot increase.
			continue;
		}
		if (const double found = influence(index, position); found > strongest) {
			strongest = found;
			(exclude ? effect.excluding : effect.including) = index;
		}
	}
	return effect;
}

/// Returns the influence of a box, sphere or cylinder.
double ShapeSet::volume_influence(std::uint32_t index, glm::dvec3 position) const {
	const Prepared &prepared = prepared_[index];
	if (!prepared.map.exists()) {
		return influence_at(prepared.volume.depth(position), shapes_[index].falloff);
	}
	const glm::dvec3 upright = prepared.map.at_middle(position);
	// A shadow has no effect on the other side of the planet.
	return upright.y > 0.0 ? influence_at(prepared.volume.depth(upright), shapes_[index].falloff) : 0.0;
}

double ShapeSet::influence(std::uint32_t index, glm::dvec3 position) const {
	const Shape &shape = shapes_[index];
	const Prepared &prepared = prepared_[index];
	if (!prepared.bounds.contains({position.x, position.z})) {
		// Outside its bounds, a shape has no effect.
		return 0.0;
	}
	if (!flat(shape)) {
		return volume_influence(index, position);
	}
	const PlanetMap &map = prepared.map;
	const glm::dvec2 from_above = map.exists() ? map.at(position) : glm::dvec2(position.x, position.z);
	if (map.exists() && !map.contains(from_above)) {
		return 0.0;
	}
	const double scale = map.exists() ? map.scale(from_above) : 1.0;
	const double falloff = scale * shape.falloff;
	if (shape.kind == ShapeKind::polygon) {
		if (!prepared.outline.contains(from_above)) {
			return 0.0;
		}
		return falloff > 0.0 ? influence_at(prepared.outline.distance(from_above, falloff), falloff) : 1.0;
	}
	const double half_width = scale * shape.half_size.x;
	return influence_at(half_width - prepared.outline.distance(from_above, half_width), falloff);
}

} // namespace thicket
