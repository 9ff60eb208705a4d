#pragma once

#include "core/placement/host_layer.hpp"
#include "core/terrain/box_tree.hpp"
#include "core/terrain/surface.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// A surface that consists of instances of models, transformed to world space. The models must
/// outlive the surface. The corners of an instance's triangles are bit-identical in every surface
/// that contains the instance.
class PlacedModels final : public Surface {
public:
	/// An instance and its model.
	struct Part {
		const Surface *model = nullptr;
		HostInstance instance;
	};

	/// Returns bounds that contain all triangles of a part, or `no_box` if it has none or its basis
	/// has no inverse.
	static Box3 bounds_of(const Part &part);

	/// Takes the parts in the order in which their triangles are numbered. Together, they must have
	/// at most max_triangles triangles. For each part, bounds_of() must not be empty. Unless there
	/// are no parts, the bounds of the surface also contain `around`.
	PlacedModels(const std::vector<Part> &parts, const Box3 &around);

	std::size_t triangle_count() const override { return ends_.empty() ? 0 : ends_.back(); }
	std::array<glm::dvec3, 3> triangle(std::uint32_t index) const override;
	const Box3 &bounds() const override { return bounds_; }
	void find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const override;

private:
	/// A part, with values that are precomputed for searches.
	struct Placed {
		const Surface *model;
		glm::dvec3 position;
		glm::dmat3 basis;
		glm::dmat3 inverse;
		bool mirrored;
		Box3 bounds;

		std::array<glm::dvec3, 3> triangle(std::uint32_t index) const;
		Box3 to_model(const Box3 &box) const;
	};

	std::vector<Placed> parts_;
	std::vector<std::size_t> ends_; ///< For each part, the number of triangles up to and including it.
	BoxTree tree_;
	Box3 bounds_ = no_box;
};

} // namespace thicket
