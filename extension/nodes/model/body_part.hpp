#pragma once

#include "nodes/model/scene_reader.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace thicket {

/// A shape of a model, with its sizes, as part of a body. Different sizes are different values.
struct BodyPart {
	enum class Kind : std::uint8_t { box, sphere, capsule, cylinder, convex };

	Kind kind = Kind::box;
	glm::vec3 size{0.0f};           ///< Meters from side to side along its own axes; unused for a convex shape.
	glm::mat3 rotation{1.0f};       ///< From its own axes to the model's.
	glm::vec3 origin{0.0f};         ///< The middle of the shape in the model.
	std::vector<glm::vec3> corners; ///< For a convex shape, in the model.

	friend bool operator==(const BodyPart &, const BodyPart &) = default;
};

/// Empty for an unsupported shape.
std::optional<BodyPart> body_part(const ModelShape &shape);

/// Returns a part of a model whose instance is scaled along the model's axes. Scales the sizes and the position of the
/// part, and keeps it right-handed whatever the scale. A capsule and a cylinder stay round, with the larger one of
/// their two scales.
BodyPart scaled(const BodyPart &part, glm::vec3 scale);

} // namespace thicket
