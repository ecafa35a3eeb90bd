from hypothesis import settings

# the same examples on every run, and no time limit on a busy machine
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
