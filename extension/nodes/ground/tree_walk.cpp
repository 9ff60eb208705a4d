#include "nodes/ground/tree_walk.hpp"

#include <godot_cpp/core/object.hpp>

using namespace godot;

namespace thicket {

void TreeWalk::start(Node *p_root) {
	path_.clear();
	path_.push_back({Variant(p_root), -1});
}

Node *TreeWalk::next() {
	while (!path_.empty()) {
		Step &step = path_.back();
		auto *node = Object::cast_to<Node>(step.node.get_validated_object());
		const int32_t child = step.next_child++;
		if (node != nullptr && child < 0) {
			return node;
		}
		if (node == nullptr || child >= node->get_child_count()) {
			path_.pop_back();
		} else {
			path_.push_back({Variant(node->get_child(child)), -1}); // Invalidates `step`.
		}
	}
	return nullptr;
}

} // namespace thicket
