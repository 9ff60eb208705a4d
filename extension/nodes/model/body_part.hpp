#pragma once

#include "nodes/model/scene_reader.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace thicket {

/// A collision shape of a model, as part of a body. Two parts are equal if all values are equal,
/// including the size.
struct BodyPart {
	enum class Kind : std::uint8_t { box, sphere, capsule, cylinder, convex };

	Kind kind = Kind::box;
	/// The extents of the shape along its local axes, in meters. Unused for a convex shape.
	glm::vec3 size{0.0f};
	glm::mat3 rotation{1.0f};       ///< The rotation from the shape's local axes to the model's.
	glm::vec3 origin{0.0f};         ///< The center of the shape in the model's space.
	std::vector<glm::vec3> corners; ///< The corners of a convex shape, in the model's space.

	friend bool operator==(const BodyPart &, const BodyPart &) = default;
};

/// Converts a collision shape of a model. Returns nothing for an unsupported shape.
std::optional<BodyPart> body_part(const ModelShape &shape);

/// Returns a part as it is in an instance that is scaled along the model's axes. Scales the part's
/// size and position and keeps its axes right-handed even if the scale is negative. Capsules and
/// cylinders stay round: their radius uses the larger of the two horizontal scales.
BodyPart scaled(const BodyPart &part, glm::vec3 scale);

} // namespace thicket
