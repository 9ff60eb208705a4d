#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/rules/outline.hpp"
#include "core/rules/planet_map.hpp"
#include "core/rules/rule_factors.hpp"
#include "core/rules/shape.hpp"
#include "core/rules/shape_volume.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The effect of a set of shapes at a position.
struct ShapeEffect {
	double included = 1.0;              ///< Largest influence of all including shapes, or 1 if the set has none.
	double excluded = 0.0;              ///< Largest influence of all excluding shapes.
	std::uint32_t including = no_index; ///< Indices of the shapes with these influences; no_index if none.
	std::uint32_t excluding = no_index;

	double density() const { return included * (1.0 - excluded); }

	/// Returns the index of the shape with the greatest effect. This is the excluding one if
	/// `excluded` is above 0 and at least 1 - `included`, otherwise the including one.
	std::uint32_t decisive() const { return excluded > 0.0 && excluded >= 1.0 - included ? excluding : including; }
};

/// The shapes that apply to one layer. Immutable after `set`, so threads may share it.
///
/// A shape's influence is 0 outside and on its border. Inside, it grows linearly to 1 over
/// `falloff` meters of depth; with a falloff of 0 it is 1 everywhere inside. The layer's density is
/// multiplied by the largest influence of all including shapes (1 if there are none), and by 1
/// minus the largest influence of all excluding shapes.
class ShapeSet {
public:
	/// Sets the shapes. If any shape is invalid, the function returns its error and leaves this
	/// object unchanged.
	Status set(std::vector<Shape> shapes);

	bool empty() const { return shapes_.empty(); }
	std::span<const Shape> shapes() const { return shapes_; }

	/// Returns true if any shape is an including shape. The layer then grows only inside including
	/// shapes.
	bool includes() const { return includes_; }

	/// Replaces `r_nearby_shapes` with the indices of the shapes that may have an effect in `area`,
	/// borders included, in ascending order. Including shapes that are not in the list still have
	/// an effect: where none is near, `density` is 0.
	Status find_nearby(const Rect &area, std::vector<std::uint32_t> &r_nearby_shapes) const;

	/// Returns the factor of the shapes, 0 to 1, at a position on the ground (world meters, y up).
	/// `nearby_shapes` is the result of find_nearby() for any area that contains the position.
	/// The factor is 0 if the position is not finite. The result is bit-identical on all platforms,
	/// because the square root is the only libm function that is used.
	double density(std::span<const std::uint32_t> nearby_shapes, glm::dvec3 position) const {
		return effect(nearby_shapes, position).density();
	}

	/// Returns the effect of the shapes at a position, and the shapes that cause it. Takes the same
	/// arguments as `density`.
	ShapeEffect effect(std::span<const std::uint32_t> nearby_shapes, glm::dvec3 position) const;

	friend bool operator==(const ShapeSet &a, const ShapeSet &b) { return a.shapes_ == b.shapes_; }

private:
	/// A shape prepared for queries: an outline for a polygon or a path, otherwise a volume.
	struct Prepared {
		Rect bounds;
		ShapeVolume volume;
		Outline outline;
		PlanetMap map; ///< Exists if the shape has a planet.
	};

	double influence(std::uint32_t index, glm::dvec3 position) const;
	double volume_influence(std::uint32_t index, glm::dvec3 position) const;

	std::vector<Shape> shapes_;
	std::vector<Prepared> prepared_; ///< One entry per shape.
	bool includes_ = false;
};

} // namespace thicket
