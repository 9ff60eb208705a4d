extends "harness.gd"
## Tests calls that need too much memory, in a process with little memory (see test_engine.py). Such a call must print an error, and later
## calls must work.


func test_a_small_window_works_after_one_that_is_too_large() -> void:
	var sampler := PoissonSampler.new()
	var small := Rect2(0, 0, 30, 30)
	var expected: PackedVector2Array = sampler.sample(small)["positions"]
	var huge: PackedVector2Array = sampler.sample(Rect2(0, 0, 11000, 11000))["positions"]
	check(huge.is_empty(), "no points without memory")
	expect_memory_error("PoissonSampler.rect")
	check(sampler.sample(small)["positions"] == expected, "the sampler still works")


func test_a_small_domain_works_after_one_that_is_too_large() -> void:
	for method: int in [PoissonSampler.METHOD_TILES, PoissonSampler.METHOD_HIERARCHICAL]:
		var sampler := PoissonSampler.new()
		sampler.method = method
		sampler.double_precision = true
		var small := Rect2(0, 0, 30, 30)
		var expected := sampler.sample_domain(small)
		check(sampler.sample_domain(Rect2(0, 0, 11000, 11000)).is_empty(), "no points without memory")
		expect_memory_error("PoissonSampler.rect")
		check(sampler.sample_domain(small) == expected, "the sampler still works")


## Checks that the library printed one memory error. The engine may also print one when an array does not fit.
func expect_memory_error(source: String) -> void:
	var messages: Array = Array(errors.take()).filter(func(message: String) -> bool: return not 'Parameter "mem' in message)
	check(messages.size() == 1, "one error, got %s" % [messages])
	for message in messages:
		check(message.begins_with(source) and "more memory than is available" in message, message)
