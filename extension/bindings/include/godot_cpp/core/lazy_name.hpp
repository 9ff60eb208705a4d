#pragma once

#include <godot_cpp/variant/string_name.hpp>

#include <atomic>
#include <optional>

namespace godot::internal {

/// A StringName that is made when it is first asked for and released when the library is closed (the engine reports those
/// that are left). May be asked for again after that: not every system forgets a library that it was told to close.
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
