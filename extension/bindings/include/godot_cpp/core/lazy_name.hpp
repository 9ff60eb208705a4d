#pragma once

#include <godot_cpp/variant/string_name.hpp>

#include <atomic>
#include <optional>

namespace godot::internal {

/// A StringName that is created on first use. The name is released when the library is unloaded,
/// because the engine reports leaked names. Later uses create the name again, because some systems
/// keep an unloaded library in memory. Any thread may use a LazyName.
class LazyName {
public:
	constexpr explicit LazyName(const char *p_text) : text_(p_text) {}

	const StringName &get() {
		if (!made_.load(std::memory_order_acquire)) {
			make();
		}
		return *name_;
	}

	static void release_all();

private:
	void make();

	const char *text_;
	std::atomic<bool> made_ = false;
	std::optional<StringName> name_;
	LazyName *next_ = nullptr;
};

} // namespace godot::internal
