"""Blend trees and state machines that are described in a file; `plan` defines the format."""
