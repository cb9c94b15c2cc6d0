"""Words of joint friction of engines that run in an interpreter of their own: each a program that prints JSON."""
