#pragma once

#include <cstddef>
#include <functional>

namespace thicket {

/// Threads that a caller lends to a call: the core makes none.
class LentThreads {
public:
	virtual ~LentThreads() = default;

	/// How many there are besides the calling one.
	virtual std::size_t count() const = 0;

	/// Calls work(0) on the calling thread and work(1) to work(count()) on others, and returns when all have. Some may begin late,
	/// one after the other, or not at all, so whoever comes first does all there is to do. `work` does not throw.
	virtual void run(const std::function<void(std::size_t index)> &work) = 0;

protected:
	LentThreads() = default;
	LentThreads(const LentThreads &) = default;
	LentThreads &operator=(const LentThreads &) = default;
};

} // namespace thicket
