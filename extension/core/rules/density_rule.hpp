#pragma once

#include "core/base/status.hpp"
#include "core/terrain/box3.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace thicket {

/// Positions on the ground at which a DensityRule is evaluated. All lists have the same size.
struct DensityBatch {
	std::span<const glm::dvec3> positions; ///< World meters.
	std::span<const glm::vec3> normals;    ///< World space.
	std::span<const float> slopes;         ///< Degrees, as for the slope rule.
	std::span<const float> weights;        ///< Total weight of the layer's ground textures; see Ground::weight.
};

/// A density that code outside the core computes, such as a script. It must be a pure function of
/// the position and the ground there: a query returns bit-identical results in any batch. Otherwise,
/// separately generated tiles would not match at their borders.
class DensityRule {
public:
	virtual ~DensityRule() = default;

	/// Returns true if several threads may call the methods below concurrently. Otherwise, only the
	/// main thread may call them. The result never changes.
	virtual bool is_thread_safe() const = 0;

	/// Writes the density at each position to `r_densities`, which has the same size. The caller
	/// clamps values to [0, 1] and treats NAN as 0.
	virtual Status sample(const DensityBatch &batch, std::span<float> r_densities) const = 0;

	/// Sets `r_closed` to true if the density is 0 everywhere in a box in world meters. The rule is
	/// then not evaluated there.
	virtual Status find_closed([[maybe_unused]] const Box3 &box, bool &r_closed) const {
		r_closed = false;
		return {};
	}

	/// Returns a message about the call that caused the error `status`; empty if the rule did not
	/// cause it. Any thread may call this function.
	virtual std::string problem([[maybe_unused]] const Status &status) const { return {}; }

protected:
	DensityRule() = default;
	DensityRule(const DensityRule &) = default;
	DensityRule &operator=(const DensityRule &) = default;
	DensityRule(DensityRule &&) = default;
	DensityRule &operator=(DensityRule &&) = default;
};

using SharedDensityRule = std::shared_ptr<const DensityRule>;

inline constexpr std::size_t max_density_rules = 16; ///< Maximum number of density rules of a layer.

} // namespace thicket
