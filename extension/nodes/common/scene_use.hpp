#pragma once

#include "nodes/common/thread_rule.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>

#include <vector>

namespace thicket {

/// Tracks the objects that a node in the tree uses. The main thread reads these objects every
/// frame, so no other thread may call methods that modify them.
class SceneUse {
public:
	class List {
	public:
		/// Adds an object. Ignores null.
		template <typename T>
		void add(const godot::Ref<T> &p_object) {
			if (p_object.is_valid()) {
				uses_.push_back({p_object, &p_object->thread_guard()});
			}
		}

	private:
		friend class SceneUse;

		struct Use {
			godot::Ref<godot::RefCounted> object; ///< Keeps `guard` valid.
			ThreadGuard *guard;
		};

		std::vector<Use> uses_;
	};

	SceneUse() = default;
	~SceneUse() { replace({}); }
	SceneUse(const SceneUse &) = delete;
	SceneUse &operator=(const SceneUse &) = delete;

	/// Marks these objects as used, and unmarks those of the previous call. If another thread is
	/// inside a method of one of them, waits for it to leave and prints an error after one second.
	/// Call it only on the main thread.
	void replace(List list);

private:
	List current_uses_;
};

} // namespace thicket
