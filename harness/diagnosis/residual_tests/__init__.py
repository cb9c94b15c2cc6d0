"""Does anything but noise stay in a residual?"""
