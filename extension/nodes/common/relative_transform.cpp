#include "nodes/common/relative_transform.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// A transform in double precision.
struct Placed {
	glm::dmat3 basis{1.0};
	glm::dvec3 origin{0.0};
};

Placed placed(const Transform3D &p_transform) { return {to_core(p_transform.basis), to_core(p_transform.origin)}; }

/// Returns the node whose transform also moves `node`; null if there is none.
const Node3D *mover_of(const Node3D &node) {
	return node.is_set_as_top_level() ? nullptr : Object::cast_to<Node3D>(node.get_parent());
}

/// Returns `node` and everything that moves it, up to the root.
std::vector<const Node3D *> chain_of(const Node3D &node) {
	std::vector<const Node3D *> chain{&node};
	while (const Node3D *mover = mover_of(*chain.back())) {
		chain.push_back(mover);
	}
	return chain;
}

/// Returns the transform of the first node of a chain in the space of the node at `end`.
Placed composed(const std::vector<const Node3D *> &chain, std::size_t end) {
	Placed result;
	for (std::size_t at = end; at > 0; --at) {
		const Placed local = placed(chain[at - 1]->get_transform());
		result.origin += result.basis * local.origin;
		result.basis = result.basis * local.basis;
	}
	return result;
}

Transform3D in_space(const Placed &space, const Placed &node) {
	const glm::dmat3 rotation = WorldFrame::of_local_space(space.basis, space.origin).rotation;
	return {to_engine(glm::mat3(rotation * node.basis)), to_engine(rotation * (node.origin - space.origin))};
}

} // namespace

Transform3D relative_transform(const Node3D &space, const Node3D &node) {
	const std::vector<const Node3D *> above_space = chain_of(space);
	const std::vector<const Node3D *> above_node = chain_of(node);
	const auto met = std::ranges::find_first_of(above_node, above_space);
	if (met == above_node.end()) {
		return in_space(placed(space.get_global_transform()), placed(node.get_global_transform()));
	}
	const auto same = std::ranges::find(above_space, *met);
	return in_space(composed(above_space, static_cast<std::size_t>(same - above_space.begin())),
			composed(above_node, static_cast<std::size_t>(met - above_node.begin())));
}

} // namespace thicket
