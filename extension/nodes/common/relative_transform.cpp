#include "nodes/common/relative_transform.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// A transform in double precision.
struct DoubleTransform {
	glm::dmat3 basis{1.0};
	glm::dvec3 origin{0.0};
};

DoubleTransform to_double(const Transform3D &p_transform) {
	return {to_core(p_transform.basis), to_core(p_transform.origin)};
}

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
DoubleTransform compose(const std::vector<const Node3D *> &chain, std::size_t end) {
	DoubleTransform result;
	for (std::size_t i = end; i > 0; --i) {
		const DoubleTransform local = to_double(chain[i - 1]->get_transform());
		result.origin += result.basis * local.origin;
		result.basis = result.basis * local.basis;
	}
	return result;
}

Transform3D in_space(const DoubleTransform &space, const DoubleTransform &node) {
	const glm::dmat3 rotation = WorldFrame::of_local_space(space.basis, space.origin).rotation;
	return {to_engine(glm::mat3(rotation * node.basis)), to_engine(rotation * (node.origin - space.origin))};
}

} // namespace

Transform3D relative_transform(const Node3D &space, const Node3D &node) {
	const std::vector<const Node3D *> space_chain = chain_of(space);
	const std::vector<const Node3D *> node_chain = chain_of(node);
	const auto ancestor = std::ranges::find_first_of(node_chain, space_chain);
	if (ancestor == node_chain.end()) {
		return in_space(to_double(space.get_global_transform()), to_double(node.get_global_transform()));
	}
	const auto ancestor_of_space = std::ranges::find(space_chain, *ancestor);
	return in_space(compose(space_chain, static_cast<std::size_t>(ancestor_of_space - space_chain.begin())),
			compose(node_chain, static_cast<std::size_t>(ancestor - node_chain.begin())));
}

} // namespace thicket
