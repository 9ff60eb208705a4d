#pragma once

#include "nodes/common/thread_rule.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>

#include <vector>

namespace thicket {

/// Objects that a node in the tree uses: the main thread reads them in its frames, so no other thread may call what changes them.
class SceneUse {
public:
	class List {
	public:
		/// A null is left out.
		template <typename T>
		void add(const godot::Ref<T> &p_object) {
			if (p_object.is_valid()) {
				uses_.push_back({p_object, &p_object->thread_guard()});
			}
		}

	private:
		friend class SceneUse;

		struct Use {
			godot::Ref<godot::RefCounted> object; ///< Keeps the guard.
			ThreadGuard *guard;
		};

		std::vector<Use> uses_;
	};

	SceneUse() = default;
	~SceneUse() { replace({}); }
	SceneUse(const SceneUse &) = delete;
	SceneUse &operator=(const SceneUse &) = delete;

	/// Takes these into use, and gives those of the last call back. Waits for another thread that is in a method of one (ThreadGuard);
	/// prints an error if that takes too long. Main thread only.
	void replace(List list);

private:
	List used_;
};

} // namespace thicket
