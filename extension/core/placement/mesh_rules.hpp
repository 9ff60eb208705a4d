#pragma once

#include "core/base/status.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/rules/rules.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// An instance that needs a mesh.
struct MeshPoint {
	std::uint64_t id = 0;
	glm::dvec2 position{0.0}; ///< World meters.
	Ground ground;
	/// The values of LayerSettings::world_sources; empty if no mesh needs any.
	std::span<const float> world_values{};
};

/// How one mesh takes part in the choice for an instance.
struct MeshShare {
	double weight = 1.0;      ///< The mesh's entry in LayerSettings::mesh_weights.
	double density = 1.0;     ///< The density of the mesh's rules at the instance, 0 to 1.
	double probability = 1.0; ///< The probability with which instances there get the mesh.

	struct Input {
		WorldInput input;
		float value = 0.0f;
	};
	std::vector<Input> inputs{}; ///< The world inputs of the mesh's expression.
};

/// Assigns meshes to the instances of a layer whose meshes have rules (LayerSettings::mesh_rules).
/// The weight of a mesh at an instance is its plain weight, multiplied by the density of its rules
/// there. If all weights are 0, the plain weights apply. The random number of an instance is the
/// same as for MeshChoice, so both choose the same mesh if all densities are 1.
class MeshRules {
public:
	/// Maximum number of points that `choose` takes in one call.
	static constexpr std::size_t capacity = 256;

	/// Memory that `choose` reuses. Each thread needs its own.
	struct Scratch {
		std::vector<glm::dvec2> positions;
		std::vector<float> heights;
		std::vector<double> densities;
		std::vector<double> weights; ///< The weights of the first mesh at all points, then those of the next mesh.
		std::vector<float> fields;
	};

	/// The layer must be valid. Throws std::bad_alloc.
	void set(const LayerSettings &layer);

	/// Returns true if no mesh has rules. MeshChoice then suffices.
	bool empty() const { return ruled_.empty(); }

	/// Sets `r_meshes[i]` to the index of the mesh for `points[i]`. If a field of the rules fails,
	/// returns its error. Throws std::bad_alloc.
	Status choose(std::span<const MeshPoint> points, std::span<std::uint8_t> r_meshes, Scratch &r_scratch) const;

	/// Replaces `r_shares` with the share of each mesh in the choice for one point. Throws
	/// std::bad_alloc.
	Status find_shares(const MeshPoint &point, std::vector<MeshShare> &r_shares) const;

private:
	struct RuledMesh {
		std::size_t mesh = 0;
		PreparedRules rules;
		std::vector<std::size_t> sources; ///< The sources of the world inputs of the expression.
	};

	void prepare(std::span<const MeshPoint> points, Scratch &r_scratch) const;
	Status find_densities(const RuledMesh &mesh, std::span<const MeshPoint> points, Scratch &r_scratch) const;

	std::vector<RuledMesh> ruled_; ///< The meshes that have rules.
	std::vector<double> weights_;  ///< The plain weights of all meshes.
	MeshChoice plain_;
	std::uint64_t seed_ = 0;
	bool on_surface_ = false;
};

/// Returns true if the rules of any mesh depend on the slope of the ground.
bool mesh_rules_need_slope(const LayerSettings &layer);

} // namespace thicket
