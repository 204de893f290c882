"""What an option that is on or off may say."""

SWITCH = {"on": True, "off": False}
