#pragma once

#include "nodes/common/thread_rule.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>

#include <vector>

namespace thicket {

/// Objects that a node in the tree uses. The main thread reads them in its frames, so no other thread may call methods that change them.
class SceneUse {
public:
	class List {
	public:
		/// Null is ignored.
		template <typename T>
		void add(const godot::Ref<T> &p_object) {
			if (p_object.is_valid()) {
				uses_.push_back({p_object, &p_object->thread_guard()});
			}
		}

	private:
		friend class SceneUse;

		struct Use {
			godot::Ref<godot::RefCounted> object; ///< Keeps the guard alive.
			ThreadGuard *guard;
		};

		std::vector<Use> uses_;
	};

	SceneUse() = default;
	~SceneUse() { replace({}); }
	SceneUse(const SceneUse &) = delete;
	SceneUse &operator=(const SceneUse &) = delete;

	/// Marks these objects as used and releases those of the last call. Waits for any other thread that is inside a method of one of them
	/// (ThreadGuard), and prints an error if that takes too long. Main thread only.
	void replace(List list);

private:
	List used_;
};

} // namespace thicket
