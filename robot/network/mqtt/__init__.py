"""The bus over an MQTT broker."""
