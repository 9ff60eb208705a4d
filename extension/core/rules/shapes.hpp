#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/rules/outline.hpp"
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
	double included = 1.0;              ///< The largest influence of all including shapes. 1 if there are none.
	double excluded = 0.0;              ///< The largest influence of all excluding shapes.
	std::uint32_t including = no_index; ///< The shapes with these influences; no_index if none.
	std::uint32_t excluding = no_index;

	double density() const { return included * (1.0 - excluded); }

	/// The shape with the greatest effect: the excluding one, unless it removes less than the including ones lack.
	std::uint32_t decisive() const { return excluded > 0.0 && excluded >= 1.0 - included ? excluding : including; }
};

/// The shapes that apply to one layer. Immutable after `set`, so threads may share one.
///
/// A shape's influence is 0 outside and on its border, grows linearly over `falloff` meters of depth, and is 1 from there on. With a
/// sharp border it is 1 everywhere inside. The layer's density is multiplied by the largest influence of all including shapes (1 if there
/// are none) and by 1 minus the largest influence of all excluding ones.
class ShapeSet {
public:
	/// Sets valid shapes. If one shape is refused, all are, and this object is unchanged.
	Status set(std::vector<Shape> shapes);

	bool empty() const { return shapes_.empty(); }
	std::span<const Shape> shapes() const { return shapes_; }

	/// True if one of the shapes is an including shape. The layer is then excluded wherever no including shape is.
	bool includes() const { return includes_; }

	/// Returns the shapes that may have an effect in `area`, borders included, as ascending indices. Replaces `r_near`. An including
	/// shape elsewhere still counts: `density` is 0 where the layer has including shapes and none is near.
	Status near(const Rect &area, std::vector<std::uint32_t> &r_near) const;

	/// The factor, 0 to 1, at a position on the ground (world meters, y up). `near` is the result of `near()` for an area that contains
	/// the position. Returns 0 at a position that is not finite. Bit-identical everywhere and for any such area: uses no libm function
	/// but square roots.
	double density(std::span<const std::uint32_t> near, glm::dvec3 position) const {
		return effect(near, position).density();
	}

	/// The effect of the shapes at a position, with the shapes that cause it. The arguments are those of `density`.
	ShapeEffect effect(std::span<const std::uint32_t> near, glm::dvec3 position) const;

	friend bool operator==(const ShapeSet &a, const ShapeSet &b) { return a.shapes_ == b.shapes_; }

private:
	/// The query structure of a shape: an outline for a polygon or a path, otherwise a volume.
	struct Prepared {
		Rect bounds;
		ShapeVolume volume;
		Outline outline;
	};

	double influence(std::uint32_t index, glm::dvec3 position) const;

	std::vector<Shape> shapes_;
	std::vector<Prepared> prepared_; ///< One per shape.
	bool includes_ = false;
};

} // namespace thicket
