"""The command `cubeling robot list`."""

from rich.console import Console
from rich.table import Table

from cubeling.app.ui.literal_text import literal_text


def list_() -> None:
    """List the serial ports of this computer and the robots that may be connected to them.

    Example: cubeling robot list
    """
    from cubeling.robot import serial_ports

    ports = serial_ports()
    console = Console()
    if not ports:
        console.print(
            "There is no serial port here. To simulate a robot: [cyan]cubeling robot simulate[/]"
        )
        return
    table = Table("port", "description", "probably")
    for port in ports:
        description = literal_text(port.description.replace("n/a", ""))  # the device's own words
        table.add_row(port.url, description, port.guess or "")
    console.print(table)
