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
		if (!is_created_.load(std::memory_order_acquire)) {
			create();
		}
		return *name_;
	}

	static void release_all();

private:
	void create();

	const char *text_;
	std::atomic<bool> is_created_ = false;
	std::optional<StringName> name_;
	LazyName *next_ = nullptr;
};

} // namespace godot::internal
